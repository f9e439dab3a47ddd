#include "bridge/localiser_core.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slalom_bridge {
namespace {

constexpr Stamp furthest = 100'000'000;  // ns, that an odometry is extrapolated

}  // namespace

LocaliserCore::LocaliserCore(const Settings& settings, Clocks clocks, Frames frames, Outputs outputs)
    : clocks_(std::move(clocks)),
      frames_(std::move(frames)),
      outputs_(std::move(outputs)),
      settings_(settings),
      watch_(settings.limits, clocks_),
      log_(clocks_.steady, outputs_.warn),
      trust_(settings.trust_scans, settings.trust_health) {}

void LocaliserCore::use_course() {
  if (settings_.course.empty()) return;
  const Course course = load_course(settings_.course);
  course_start_ = course.start;
  use_map(course.map);
  outputs_.map(course.map);
}

void LocaliserCore::use_map(const Grid& map) {
  localiser_.use_map(map);
  begin();
}

/// Starts at the last pose, at that of an earlier node, at the one that was told, at the start of the course,
/// or everywhere.
void LocaliserCore::begin() {
  if (known_) return localiser_.start_at(known_->map);
  if (settings_.earlier) return continue_from(*settings_.earlier);
  if (settings_.everywhere) return localiser_.start_everywhere();
  if (settings_.start) return hear_start(*settings_.start);
  if (course_start_) return localiser_.start_at(*course_start_);
  localiser_.start_everywhere();
}

/// The car moves until it stands without a localiser, so where it is now follows from the odometry.
void LocaliserCore::continue_from(const KnownPlace& earlier) {
  const KnownPlace rear{moved_ahead(earlier.map, settings_.rear_axle),
                        moved_ahead(earlier.odometry, settings_.rear_axle)};
  localiser_.start_at(count_ == 0 ? rear.map : place_now(rear, odometry(count_ - 1).pose));
}

void LocaliserCore::hear_map(const Grid& map) {
  try {
    use_map(map);
    outputs_.inform("a map of " + std::to_string(map.width) + " x " + std::to_string(map.height) + " cells");
  } catch (const std::exception& error) {
    log_(std::string("map: ") + error.what());
  }
}

void LocaliserCore::hear_start(const Pose& base) {
  settings_.earlier.reset();
  localiser_.start_at(moved_ahead(base, settings_.rear_axle));
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

void LocaliserCore::hear_scan(Stamp stamp, const std::string& frame, const Scan& scan, double angle_max) {
  if (!watch_.accepts("scan", in_seconds(stamp), in_seconds(last_scan_)))
    return localisation_warning(watch_.fault());
  last_scan_ = stamp;
  Pose at;
  if (!odometry_at(stamp, at)) return localisation_warning("no odometry at the time of the scan");
  place_laser(frame);
  Scan used = scan;
  if (!count_fits(scan, angle_max)) used.count = 0;
  estimate_ = localiser_.update(used, at, in_seconds(stamp));
  slowest_ = std::max(slowest_, estimate_.update_time);
  if (!trust_.update(estimate_))
    return localisation_warning(trust_.doubt() + ", health " + std::to_string(estimate_.health));
  known_ = {estimate_.pose, at};
  outputs_.pose(moved_ahead(estimate_.pose, -settings_.rear_axle), estimate_, stamp);
  // In the future, so that it is valid until the next scan has been processed.
  outputs_.transform(estimate_.odometry_frame, stamp + stamp_of(settings_.transform_tolerance));
}

/// The odometry of the rear axle at the time of the scan: interpolated between messages, extrapolated by
/// speed after the last.
bool LocaliserCore::odometry_at(Stamp stamp, Pose& rear) const {
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
    const Pose from = before.pose;
    const double share = in_seconds(stamp - before.stamp) / in_seconds(last.stamp - before.stamp);
    rear = {from.x + share * (rear.x - from.x), from.y + share * (rear.y - from.y),
            from.yaw + share * std::remainder(rear.yaw - from.yaw, 6.283185307179586)};
  }
  return true;
}

void LocaliserCore::place_laser(const std::string& frame) {
  try {
    Pose laser = frames_.mount(frame).planar();
    laser.x -= settings_.rear_axle;
    if (same_place(laser, localiser_.laser())) return;
    localiser_.change({{"laser_x", std::to_string(laser.x)},
                       {"laser_y", std::to_string(laser.y)},
                       {"laser_yaw", std::to_string(laser.yaw)}});
  } catch (const std::exception& error) {
    localisation_warning(std::string("uses the pose of the laser in the parameters; tf: ") + error.what());
  }
}

void LocaliserCore::tick() {
  if (!watch_.clock_runs()) {
    frames_.forget();
    count_ = 0;
    last_scan_ = 0;
    if (known_) localiser_.start_at(known_->map);
    log_(watch_.fault());
  }
  log_.flush();
}

std::optional<KnownPlace> LocaliserCore::reliable() const {
  if (!known_ || !trust_.holds()) return std::nullopt;
  return KnownPlace{moved_ahead(known_->map, -settings_.rear_axle),
                    moved_ahead(known_->odometry, -settings_.rear_axle)};
}

Report LocaliserCore::report() {
  Report r;
  r.about = "localisation";
  r.add("status", estimate_.status);
  r.add("health", estimate_.health);
  r.add("fraction of beams explained", estimate_.fit);
  r.add("fraction of weight in one cluster", estimate_.share);
  r.add("effective sample size", estimate_.effective_samples);
  r.add("particles", estimate_.particles);
  r.add("slowest update, ms", 1e3 * slowest_);
  const bool seen = last_scan_ != 0 && clocks_.now() - in_seconds(last_scan_) < 1;
  r.message = !localiser_.has_map() ? "no map" : !seen ? "no scans" : std::string(estimate_.status);
  r.level = seen && trust_.holds() ? Level::ok : Level::error;
  slowest_ = 0;
  return r;
}

}  // namespace slalom_bridge
