#include "evaluation/tracking/tracking_meter.hpp"

#include <algorithm>

#include "slalom/sim/shapes.hpp"

namespace slalom::evaluation {
namespace {

constexpr double far_away = 8;          // m, farther bodies do not count
constexpr int min_beams = 5;            // on a body in view
constexpr double long_in_view = 0.2;    // s
constexpr double match_distance = 0.5;  // m
constexpr double min_speed = 0.5;       // m/s, of bodies that count without a map
constexpr double largest_jump =
    0.5;  // m, of the localiser from the odometry's pose, where that one fits the scan

sim::WheelOdometryOptions seeded_wheels(TrackingMode mode, std::uint64_t seed) {
  sim::WheelOdometryOptions options{.seed = seed};
  // Without a map nothing corrects the yaw, and the steering does not give it while tyres slip.
  options.yaw_from_gyro = mode == TrackingMode::mapless;
  return options;
}

std::optional<vehicle::Localiser> make_localiser(TrackingMode mode, const maps::OccupancyGrid& map,
                                                 const maps::Pose& mount, const maps::Pose& start,
                                                 std::uint64_t seed) {
  if (mode != TrackingMode::localised) return std::nullopt;
  std::optional<vehicle::Localiser> localiser;
  localiser.emplace(map, vehicle::LocaliserOptions{
                             .seed = seed, .laser_x = mount.x, .laser_y = mount.y, .laser_yaw = mount.yaw});
  localiser->start_at(start);
  return localiser;
}

double distance(const maps::Pose& a, const maps::Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// The tracker knows how noisy its LiDAR is.
tracking::ObjectTracker make_tracker(TrackingMode mode, const maps::OccupancyGrid& map, double noise) {
  tracking::TrackerOptions options;
  options.range_deviation = std::max(options.range_deviation, noise);
  return mode == TrackingMode::mapless ? tracking::ObjectTracker(options)
                                       : tracking::ObjectTracker(map, options);
}

/// A pose in the frame of `frame`, in the frame in which `frame` is given.
maps::Pose compose(const maps::Pose& frame, const maps::Pose& pose) {
  const maps::Point at = maps::transform(frame, {pose.x, pose.y});
  return {at.x, at.y, maps::wrap_angle(frame.yaw + pose.yaw)};
}

/// The frame in which `pose` is given, in the frame of `pose`.
maps::Pose inverse(const maps::Pose& pose) {
  const maps::Point at = maps::inverse_transform(pose, {0, 0});
  return {at.x, at.y, -pose.yaw};
}

}  // namespace

TrackingMeter::TrackingMeter(TrackingMode mode, const maps::OccupancyGrid& map, const sim::World& world,
                             std::size_t own, std::uint64_t seed)
    : mode_(mode),
      own_(own),
      car_(world.options().car),
      mount_(compose({car_.rear_length, 0, 0}, world.options().lidar.mount)),
      wheels_(car_, seeded_wheels(mode, seed)),
      localiser_(make_localiser(mode, map, mount_, sim::rear_axle(car_, world.state(own)), seed)),
      aligned_(compose(sim::rear_axle(car_, world.state(own)), mount_)),
      tracker_(make_tracker(mode, map, world.options().lidar.noise)),
      ranges_(world.lidar().padded_beams()),
      body_ranges_(ranges_.size()) {
  wheels_.reset(world.state(own));
  wheels_before_ = wheels_.pose();
}

tracking::TrackerInput TrackingMeter::locate(const sim::Observation& seen,
                                             const maps::LaserScanView& scan) noexcept {
  tracking::TrackerInput input{.scan = scan, .sensor = seen.sensor, .stamp = seen.time};
  if (mode_ == TrackingMode::mapless) input.sensor = compose(wheels_.pose(), mount_);
  if (!localiser_) return input;
  const vehicle::LocaliserOutput& out = localiser_->update({scan, wheels_.pose(), seen.time});
  const maps::Pose localised = compose(out.pose, mount_), continued = carried_on();
  // A localiser in doubt may be sure of a wrong place afterwards. What fits the scan is not left for it.
  const bool jumps = fits_ && distance(localised, continued) > largest_jump;
  if (out.status == vehicle::LocaliserStatus::ok && !jumps) {
    input.sensor = localised;
    input.position_deviation = std::sqrt(0.5 * (out.covariance[0][0] + out.covariance[1][1]));
    input.yaw_deviation = std::sqrt(out.covariance[2][2]);
  } else {
    input.sensor = continued;
    input.position_deviation = 0.02;
    input.yaw_deviation = 0.02;
  }
  wheels_before_ = wheels_.pose();
  return input;
}

/// The last pose of the LiDAR that was aligned with the map, carried on by the odometry.
maps::Pose TrackingMeter::carried_on() const noexcept {
  const maps::Point moved = maps::inverse_transform(wheels_before_, {wheels_.pose().x, wheels_.pose().y});
  const maps::Pose turned{moved.x, moved.y, wheels_.pose().yaw - wheels_before_.yaw};
  return compose(compose(compose(aligned_, inverse(mount_)), turned), mount_);
}

std::span<const tracking::TrackedObject> TrackingMeter::observe(const sim::World& world,
                                                                const maps::LaserScanView& scan) {
  const sim::Observation seen = world.observe(own_);
  const tracking::TrackerOutput& output = tracker_.update(locate(seen, scan));
  aligned_ = output.sensor;
  fits_ = output.status == tracking::TrackerStatus::ok;
  record_.update_ms.push_back(static_cast<float>(1e3 * output.update_time));
  find_in_view(world, seen.sensor);
  compare(world, output, seen.sensor);
  if (mode_ == TrackingMode::mapless) return {};
  return output.objects;
}

void TrackingMeter::find_in_view(const sim::World& world, const maps::Pose& sensor) {
  const std::size_t bodies = world.bodies();
  in_view_.assign(bodies, 0);
  in_view_since_.resize(bodies, std::numeric_limits<double>::infinity());
  const sim::Lidar& lidar = world.lidar();
  lidar.scan(world.track(), sensor, ranges_);
  for (std::size_t body = 0; body < bodies; ++body)
    if (counts(world, body)) lidar.cast(sensor, world.outline(body), ranges_);
  for (std::size_t body = 0; body < bodies; ++body) {
    if (!counts(world, body)) {
      in_view_since_[body] = std::numeric_limits<double>::infinity();
      continue;
    }
    const sim::Box box = world.outline(body);
    const bool moves = body < world.cars() && std::abs(world.state(body).speed) >= min_speed;
    int beams = 0;
    if (std::hypot(box.pose.x - sensor.x, box.pose.y - sensor.y) <= far_away &&
        (moves || mode_ != TrackingMode::mapless)) {
      std::fill(body_ranges_.begin(), body_ranges_.end(), std::numeric_limits<float>::max());
      lidar.cast(sensor, box, body_ranges_);
      for (std::size_t i = 0; i < lidar.angles().size(); ++i) beams += body_ranges_[i] <= ranges_[i];
    }
    in_view_[body] = beams >= min_beams;
    in_view_since_[body] = in_view_[body] ? std::min(in_view_since_[body], world.time())
                                          : std::numeric_limits<double>::infinity();
  }
}

/// Pairs bodies in view with objects, the nearest ones first.
template <class InMap>
void TrackingMeter::pair_up(const sim::World& world, const tracking::TrackerOutput& output,
                            const InMap& in_map) {
  pairs_.assign(world.bodies(), nullptr);
  taken_.assign(output.objects.size(), 0);
  while (true) {
    std::size_t best_body = own_, best_object = 0;
    double least = match_distance;
    for (std::size_t body = 0; body < world.bodies(); ++body) {
      if (!in_view_[body] || pairs_[body]) continue;
      for (std::size_t i = 0; i < output.objects.size(); ++i) {
        const double apart = distance(world.outline(body).pose, in_map(output.objects[i].pose));
        if (taken_[i] || apart > least) continue;
        least = apart;
        best_body = body;
        best_object = i;
      }
    }
    if (best_body == own_) return;
    pairs_[best_body] = &output.objects[best_object];
    taken_[best_object] = 1;
  }
}

void TrackingMeter::compare(const sim::World& world, const tracking::TrackerOutput& output,
                            const maps::Pose& sensor) {
  // Without a map the objects are in the frame of the odometry, which drifts: compared as seen from the car.
  const auto in_map = [&](const maps::Pose& pose) {
    if (mode_ != TrackingMode::mapless) return pose;
    const maps::Point at = maps::inverse_transform(output.sensor, {pose.x, pose.y});
    return compose(sensor, {at.x, at.y, pose.yaw - output.sensor.yaw});
  };
  pair_up(world, output, in_map);
  for (std::size_t body = 0; body < world.bodies(); ++body) {
    if (!in_view_[body]) continue;
    const maps::Pose truth = world.outline(body).pose;
    const bool settled = world.time() - in_view_since_[body] >= long_in_view;
    ++record_.in_view;
    record_.long_in_view += settled;
    const tracking::TrackedObject* object = pairs_[body];
    if (!object) continue;
    ++record_.detected;
    record_.long_detected += settled;
    const maps::Pose found = in_map(object->pose);
    const double speed = body < world.cars() ? world.state(body).speed : 0;
    double turned = maps::wrap_angle(found.yaw - truth.yaw);
    if (std::abs(speed) < min_speed) turned = std::remainder(turned, std::numbers::pi);
    const double apart = distance(truth, found);
    record_.position_error += apart * apart;
    record_.speed_error += (object->speed - speed) * (object->speed - speed);
    record_.yaw_error += turned * turned;
  }
  for (const tracking::TrackedObject& object : output.objects) {
    if (object.unseen > 0) continue;
    bool real = false;
    for (std::size_t body = 0; body < world.bodies() && !real; ++body)
      real = counts(world, body) && distance(world.outline(body).pose, in_map(object.pose)) <= match_distance;
    const auto at = std::lower_bound(false_ids_.begin(), false_ids_.end(), object.id);
    if (!real && (at == false_ids_.end() || *at != object.id)) false_ids_.insert(at, object.id);
  }
}

TrackingRecord TrackingMeter::record() const {
  TrackingRecord record = record_;
  record.false_objects = static_cast<int>(false_ids_.size());
  const double detected = std::max(record.detected, 1);
  for (double* error : {&record.position_error, &record.speed_error, &record.yaw_error})
    *error = std::sqrt(*error / detected);
  return record;
}

}  // namespace slalom::evaluation
