#include "logic/planner_core.hpp"

namespace slalom::nodes {
/// Rotates a sample to the axes of the base frame. The distance of the unit from the centre of gravity is
/// neglected: it changes the accelerations by the distance times the squared yaw rate.
void PlannerCore::hear_imu(const ImuMessage& sample) {
  const Mount* const mount = imu_mount(sample.frame);
  if (!mount) return;
  const ImuReading reading{along(2, *mount, sample.turn), along(0, *mount, sample.acceleration),
                           along(1, *mount, sample.acceleration)};
  if (!plausible(reading)) return;
  imu_sum_.yaw_rate += reading.yaw_rate;
  imu_sum_.forward += reading.forward;
  imu_sum_.leftward += reading.leftward;
  ++imu_count_;
}

/// The mount of the unit; null if tf does not know it. Then it is looked up again after a second.
const Mount* PlannerCore::imu_mount(const std::string& frame) {
  const auto found = imu_mounts_.find(frame);
  if (found != imu_mounts_.end()) return &found->second;
  const double now = clocks_.steady();
  if (now < imu_retry_) return nullptr;
  imu_retry_ = now + 1;
  try {
    return &imu_mounts_.emplace(frame, transforms_.mount(frame)).first->second;
  } catch (const std::exception& error) {
    // Not through the throttled log, whose other messages say why the car stops.
    if (!std::exchange(imu_warned_, true)) outputs_.warn(std::string("imu is not used; tf: ") + error.what());
    return nullptr;
  }
}

void PlannerCore::hear_goal_speed(double speed) {
  if (!std::isfinite(speed)) return log_("goal speed is not finite; ignored");
  goal_speed_ = std::max(speed, 0.0);
}

void PlannerCore::hear_covariance(Stamp stamp, const vehicle::PoseCovariance& covariance) {
  for (const auto& row : covariance)
    if (!std::isfinite(row[0] + row[1] + row[2])) return;
  covariance_ = covariance;
  covariance_stamp_ = stamp;
}

void PlannerCore::hear_executed(const Command& command) {
  executed_ = command;
  executed_heard_ = clocks_.steady();
}

void PlannerCore::hear_points(Stamp stamp, const std::string& frame,
                              std::span<const std::array<double, 3>> points) try {
  points_stamp_ = std::max<Stamp>(points_stamp_, 1);  // from now on `fresh` reports that there are none
  const Mount mount = transforms_.mount(frame);
  heard_points_.clear();
  for (const auto& [x, y, z] : points.first(std::min(points.size(), heard_points_.capacity())))
    if (const double at[3] = {x, y, z}; std::isfinite(x + y + z))
      heard_points_.push_back({mount.x + along(0, mount, at), mount.y + along(1, mount, at)});
  heard_points_stamp_ = stamp;
} catch (const std::exception&) {  // without a transform they are not used
}

void PlannerCore::hear_objects(Stamp stamp, std::span<const tracking::TrackedObject> objects) {
  if (others_watch_ && others_from_ == OthersFrom::topic) others_watch_->hear(objects, in_seconds(stamp));
  objects_stamp_ = stamp;
}

void PlannerCore::forget_inputs() {
  imu_sum_ = {};
  imu_count_ = 0;
  imu_mounts_.clear();
  executed_heard_ = -1e9;
  points_.clear();
  covariance_stamp_ = points_stamp_ = heard_points_stamp_ = objects_stamp_ = 0;
}

bool PlannerCore::has_fresh_inputs() {
  if (heard_points_stamp_ != 0 && transforms_.knows(heard_points_stamp_)) {
    const maps::Pose base = transforms_.pose(heard_points_stamp_);
    points_.clear();
    for (const maps::Point& each : heard_points_) points_.push_back(maps::transform(base, each));
    points_stamp_ = std::exchange(heard_points_stamp_, 0);
  }
  return (points_stamp_ == 0 || watch_.fresh("obstacle points", in_seconds(points_stamp_))) &&
         (others_from_ != OthersFrom::topic || watch_.fresh("tracked objects", in_seconds(objects_stamp_)));
}

/// The command that the car executes, if it was heard lately and is none of the planner's.
std::optional<Command> PlannerCore::obeyed() const {
  const bool ours = std::any_of(sent_lately_.begin(), sent_lately_.end(), [&](const Command& each) {
    return std::abs(each.steer - executed_.steer) < 1e-3 && std::abs(each.speed - executed_.speed) < 1e-2;
  });
  if (ours || clocks_.steady() - executed_heard_ > settings_.limits.max_age) return std::nullopt;
  return executed_;
}

/// Adds the inputs to one with scan and pose.
void PlannerCore::complete(vehicle::PlannerInput& input) {
  const double now = in_seconds(scan_stamp_), samples = imu_count_;
  if (imu_count_ > 0)
    input.imu = {imu_sum_.yaw_rate / samples, imu_sum_.forward / samples, imu_sum_.leftward / samples};
  imu_sum_ = {};
  imu_count_ = 0;
  input.goal_speed = goal_speed_;
  input.obeyed = obeyed();
  if (covariance_stamp_ != 0 && std::abs(now - in_seconds(covariance_stamp_)) < settings_.limits.max_age)
    input.odometry.covariance = covariance_;
  points_of_car_.clear();
  for (const maps::Point& each : points_)
    points_of_car_.push_back(maps::inverse_transform(input.odometry.pose, each));
  input.obstacles = points_of_car_;
  const vehicle::PoseCovariance& covariance = input.odometry.covariance;
  const vehicle::PlannerOptions& at = configuration_.planner;
  if (others_watch_ && others_from_ == OthersFrom::scan)
    others_watch_->see({.scan = input.scan,
                        .sensor = composed(input.odometry.pose, {at.laser_x, at.laser_y, at.laser_yaw}),
                        .stamp = now,
                        .position_deviation = std::sqrt(0.5 * (covariance[0][0] + covariance[1][1])),
                        .yaw_deviation = std::sqrt(covariance[2][2])});
  if (others_watch_) input.others = others_watch_->predict(now);
  others_ = input.others.size();
}

}  // namespace slalom::nodes
