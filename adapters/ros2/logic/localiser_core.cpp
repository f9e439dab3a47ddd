#include "logic/localiser_core.hpp"

#include "slalom/sim/wheel_odometry.hpp"

namespace slalom::nodes {
LocaliserCore::LocaliserCore(const Settings& settings, Clocks clocks, Transforms transforms, Outputs outputs)
    : clocks_(std::move(clocks)),
      transforms_(std::move(transforms)),
      outputs_(std::move(outputs)),
      settings_(settings),
      watch_(settings.limits, clocks_),
      log_(clocks_.steady, outputs_.warn),
      trust_(settings.trust_scans, settings.trust_health) {}

std::vector<NamedOption> LocaliserCore::options() const {
  std::vector<NamedOption> all;
  for (const OptionEntry& entry : list_options(options_)) all.push_back({entry.declaration.name, entry});
  return all;
}

void LocaliserCore::change(const Changes& changes) {
  vehicle::LocaliserOptions changed = options_;
  for (const auto& [name, text] : changes) try {
      if (!set_option(changed, name, text)) throw std::invalid_argument("unknown option of the localiser");
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("key " + name + ": " + error.what());
    }
  changed.validate();
  if (localiser_) {
    localiser_.emplace(vehicle::Localiser(map_, changed));
    start_at(start_);
  }
  options_ = changed;
}

void LocaliserCore::use_course() {
  if (settings_.course.empty()) return;
  const vehicle::Course course = load_course(settings_.course);
  course_start_ = sim::rear_axle({}, {.x = course.start.x, .y = course.start.y, .yaw = course.start.yaw});
  use_map(reachable_map(course));
  outputs_.map(course.map);
}

void LocaliserCore::use_map(const maps::OccupancyGrid& map) {
  localiser_.emplace(vehicle::Localiser(map, options_));
  map_ = map;
  start_.reset();
  begin();
}

/// Starts at a pose of the rear axle, or everywhere.
void LocaliserCore::start_at(const std::optional<maps::Pose>& rear) {
  if (!localiser_) return;
  start_ = rear;
  if (rear)
    localiser_->start_at(*rear);
  else
    localiser_->start_everywhere();
}

/// Starts at the last pose, that of an earlier node, that which was told, that of the course, or everywhere.
void LocaliserCore::begin() {
  if (known_) return start_at(known_->map);
  if (settings_.earlier) return continue_from(*settings_.earlier);
  if (settings_.everywhere) return start_at({});
  if (settings_.start) return hear_start(*settings_.start);
  start_at(course_start_);
}

/// The car moves without a localiser until it stands, so its place now follows from the odometry.
void LocaliserCore::continue_from(const KnownPose& earlier) {
  const KnownPose rear{moved_ahead(earlier.map, settings_.rear_axle),
                       moved_ahead(earlier.odometry, settings_.rear_axle)};
  start_at(count_ == 0 ? rear.map : pose_now(rear, odometry(count_ - 1).pose));
}

void LocaliserCore::hear_map(const maps::OccupancyGrid& map) {
  try {
    use_map(map);
    outputs_.inform("a map of " + std::to_string(map.width) + " x " + std::to_string(map.height) + " cells");
  } catch (const std::exception& error) {
    log_(std::string("map: ") + error.what());
  }
}

void LocaliserCore::hear_start(const maps::Pose& base) {
  settings_.earlier.reset();
  start_at(moved_ahead(base, settings_.rear_axle));
}

void LocaliserCore::hear_odometry(const OdometrySample& sample) {
  const Stamp last = count_ == 0 ? 0 : odometry(count_ - 1).stamp;
  if (!watch_.accepts("odometry", in_seconds(sample.stamp), in_seconds(last)))
    return localisation_warning(watch_.fault());
  if (count_ == odometry_.size())
    oldest_ = (oldest_ + 1) % odometry_.size();
  else
    ++count_;
  OdometrySample& newest = odometry_[(oldest_ + count_ - 1) % odometry_.size()];
  newest = sample;
  newest.pose = moved_ahead(sample.pose, settings_.rear_axle);
  if (count_ == 1 && !known_ && settings_.earlier) continue_from(*settings_.earlier);
}

void LocaliserCore::hear_scan(Stamp stamp, const std::string& frame, const maps::LaserScanView& scan,
                              double angle_max) {
  if (!watch_.accepts("scan", in_seconds(stamp), in_seconds(last_scan_)))
    return localisation_warning(watch_.fault());
  last_scan_ = stamp;
  if (!localiser_) return localisation_warning("no map");
  maps::Pose at;
  if (!odometry_at(stamp, at)) return localisation_warning("no odometry at the time of the scan");
  place_laser(frame);
  maps::LaserScanView used = scan;
  if (!count_fits(scan, angle_max)) used.ranges = {};
  estimate_ = localiser_->update({used, at, in_seconds(stamp)});
  if (estimate_.status == vehicle::LocaliserStatus::ok) start_ = estimate_.pose;
  slowest_ = std::max(slowest_, estimate_.update_time);
  if (!trust_.update(estimate_))
    return localisation_warning(trust_.doubt() + ", health " + std::to_string(estimate_.health));
  known_ = {estimate_.pose, at};
  outputs_.pose(moved_ahead(estimate_.pose, -settings_.rear_axle), estimate_, stamp);
  // In the future, so that it is valid until the next scan has been processed.
  outputs_.transform(localiser_->odometry_frame(), stamp + stamp_of(settings_.transform_tolerance));
}

/// The odometry of the rear axle at a time: interpolated, or extrapolated by speed after the last message.
bool LocaliserCore::odometry_at(Stamp stamp, maps::Pose& rear) const {
  constexpr Stamp furthest = 100'000'000;  // ns, that an odometry is extrapolated
  if (count_ == 0) return false;
  std::size_t after = 0;
  while (after < count_ && odometry(after).stamp < stamp) ++after;
  if (after == 0 && odometry(0).stamp != stamp) return false;
  const OdometrySample& last = odometry(std::min(after, count_ - 1));
  rear = last.pose;
  const Stamp ahead = stamp - last.stamp;
  if (after == count_) {
    if (ahead > furthest) return false;
    const double turned = last.yaw_rate * in_seconds(ahead);
    rear.yaw += 0.5 * turned;
    rear = moved_ahead(rear, last.speed * in_seconds(ahead));
    rear.yaw += 0.5 * turned;
  } else if (ahead < 0) {
    const OdometrySample& before = odometry(after - 1);
    const maps::Pose from = before.pose;
    const double share = in_seconds(stamp - before.stamp) / in_seconds(last.stamp - before.stamp);
    rear = {from.x + share * (rear.x - from.x), from.y + share * (rear.y - from.y),
            from.yaw + share * maps::wrap_angle(rear.yaw - from.yaw)};
  }
  return true;
}

void LocaliserCore::place_laser(const std::string& frame) {
  try {
    maps::Pose laser = transforms_.mount(frame).planar();
    laser.x -= settings_.rear_axle;
    if (same_place(laser, {options_.laser_x, options_.laser_y, options_.laser_yaw})) return;
    change({{"laser_x", std::to_string(laser.x)},
            {"laser_y", std::to_string(laser.y)},
            {"laser_yaw", std::to_string(laser.yaw)}});
  } catch (const std::exception& error) {
    localisation_warning(std::string("uses the pose of the laser in the parameters; tf: ") + error.what());
  }
}

void LocaliserCore::tick() {
  if (!watch_.clock_runs()) {
    transforms_.forget();
    count_ = 0;
    last_scan_ = 0;
    if (known_) start_at(known_->map);
    log_(watch_.fault());
  }
  log_.flush();
}

std::optional<KnownPose> LocaliserCore::reliable() const {
  if (!known_ || !trust_.holds()) return std::nullopt;
  return KnownPose{moved_ahead(known_->map, -settings_.rear_axle),
                   moved_ahead(known_->odometry, -settings_.rear_axle)};
}

std::vector<maps::Pose> LocaliserCore::particles(int most) const {
  std::vector<maps::Pose> some;
  if (!localiser_ || most < 1) return some;
  const int count = localiser_->particle_count(), step = (count - 1) / most + 1;
  for (int i = 0; i < count; i += step) some.push_back(localiser_->particle(i).pose);
  return some;
}

Report LocaliserCore::report() {
  Report r{.about = "localisation"};
  r.add("status", vehicle::name(estimate_.status));
  r.add("health", estimate_.health);
  r.add("fraction of beams explained", estimate_.fit);
  r.add("fraction of weight in one cluster", estimate_.share);
  r.add("effective sample size", estimate_.effective_samples);
  r.add("particles", estimate_.particles);
  r.add("slowest update, ms", 1e3 * slowest_);
  const bool seen = last_scan_ != 0 && clocks_.now() - in_seconds(last_scan_) < 1;
  r.message = !localiser_ ? "no map" : !seen ? "no scans" : vehicle::name(estimate_.status);
  r.level = seen && trust_.holds() ? Level::ok : Level::error;
  slowest_ = 0;
  return r;
}

}  // namespace slalom::nodes
