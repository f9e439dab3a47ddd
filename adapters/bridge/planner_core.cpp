#include "bridge/planner_core.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace slalom_bridge {
namespace {

constexpr double patience = 1.6;  // control periods without a command, after which the inputs are checked
constexpr double wait_for_pose = 0.8;  // control periods that a scan waits for the transforms of its time

/// A path is closed if its end is near its start.
bool is_closed(const std::vector<Waypoint>& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y);
  const double gap = std::hypot(path.front().x - path.back().x, path.front().y - path.back().y);
  return gap < 5 * length / static_cast<double>(path.size());
}

}  // namespace

PlannerCore::PlannerCore(const Settings& settings, Clocks clocks, Frames frames, Outputs outputs)
    : clocks_(std::move(clocks)),
      frames_(std::move(frames)),
      outputs_(std::move(outputs)),
      settings_(settings),
      watch_(settings.limits, clocks_),
      log_(clocks_.steady, outputs_.warn),
      planner_(settings.configuration, settings.method) {}

void PlannerCore::use_course() {
  if (settings_.course.empty()) return;
  const Course course = load_course(settings_.course);
  use_path(course.waypoints, course.closed);
}

void PlannerCore::use_path(const std::vector<Waypoint>& path, bool closed) {
  planner_.use_path(path);
  laps_ = closed ? LapCount(path) : LapCount();
  laps_to_drive_ = 0;
  outputs_.path(path, closed);
}

/// A scan waits a little for the transforms of its time, which arrive on another topic.
bool PlannerCore::scan_is_due() const {
  if (!new_scan_) return false;
  return clocks_.steady() - scan_heard_ > wait_for_pose * planner_.control_period() ||
         frames_.knows(scan_stamp_);
}

void PlannerCore::start_anew() {
  frames_.forget();
  scan_stamp_ = used_ = odometry_stamp_ = 0;
  imu_.clear();
  imu_mounts_.clear();
  new_scan_ = false;
  watch_.forget();
}

void PlannerCore::hear_scan(Stamp stamp, const std::string& frame, const Scan& scan, double angle_max) {
  if (!watch_.accepts("scan", in_seconds(stamp), in_seconds(scan_stamp_))) return;
  if (!count_fits(scan, angle_max))
    return watch_.report("the number of ranges of the scan does not match its angles");
  if (used_ != 0 && in_seconds(stamp - used_) < settings_.scan_interval) return;
  ranges_.assign(scan.ranges, scan.ranges + scan.count);
  scan_ = scan;
  scan_.ranges = ranges_.data();
  if (scan_frame_ != frame) scan_frame_ = frame;
  scan_stamp_ = stamp;
  scan_heard_ = clocks_.steady();
  new_scan_ = true;
}

void PlannerCore::hear_odometry(Stamp stamp, double speed) {
  if (!watch_.accepts("odometry", in_seconds(stamp), in_seconds(odometry_stamp_))) return;
  if (!std::isfinite(speed)) return watch_.report("the speed of the odometry is not finite");
  odometry_stamp_ = stamp;
  speed_ = speed;
}

/// Rotates a sample to the axes of the base frame. How far the unit is from the centre of gravity is
/// neglected: it changes the accelerations by the distance times the squared yaw rate.
void PlannerCore::hear_imu(const ImuMessage& sample) {
  const Mount* const mount = imu_mount(sample.frame);
  if (!mount) return;
  imu_.add(along(2, *mount, sample.turn), along(0, *mount, sample.acceleration),
           along(1, *mount, sample.acceleration));
}

/// Where the unit is; null if tf does not know it. Then it is looked up again after a second.
const Mount* PlannerCore::imu_mount(const std::string& frame) {
  const auto found = imu_mounts_.find(frame);
  if (found != imu_mounts_.end()) return &found->second;
  const double now = clocks_.steady();
  if (now < imu_retry_) return nullptr;
  imu_retry_ = now + 1;
  try {
    return &imu_mounts_.emplace(frame, frames_.mount(frame)).first->second;
  } catch (const std::exception& error) {
    // Not through the throttled log, whose other messages say why the car stops.
    if (!std::exchange(imu_warned_, true)) outputs_.warn(std::string("imu is not used; tf: ") + error.what());
    return nullptr;
  }
}

void PlannerCore::hear_other_command(const std::string& name) {
  watch_.report("another node commands the car" + (name.empty() ? "" : ": " + name));
}

void PlannerCore::hear_goal_speed(double speed) {
  if (!std::isfinite(speed)) return log_("goal speed is not finite; ignored");
  stopped_by_goal_ = speed <= 0;
  if (stopped_by_goal_) return;
  try {
    planner_.change({{"planner/max_speed", std::to_string(std::clamp(speed, 0.01, 100.0))}});
  } catch (const std::exception& error) {
    log_(std::string("goal_speed: ") + error.what());
  }
}

void PlannerCore::hear_path(const std::vector<Waypoint>& path) {
  try {
    if (path.size() < 3) throw std::invalid_argument("fewer than 3");
    use_path(path, is_closed(path));
  } catch (const std::exception& error) {
    log_(std::string("waypoints: ") + error.what() + "; ignored");
  }
}

void PlannerCore::drive_laps(int laps) {
  if (laps < 0) throw std::invalid_argument("laps: " + std::to_string(laps) + " must be at least 0");
  if (!laps_.counts()) throw std::invalid_argument("laps: there is no closed path");
  laps_.restart();
  laps_to_drive_ = laps;
}

/// The pose of the rear axle at the time of the scan. Returns false and reports the fault if it is unknown.
bool PlannerCore::find_pose(Pose& pose) {
  try {
    pose = moved_ahead(frames_.pose(scan_stamp_), settings_.rear_axle);
    place_laser();
  } catch (const std::exception& error) {
    watch_.report_consequence(std::string("tf: ") + error.what());
    return false;
  }
  return watch_.moves_like_a_car(pose, in_seconds(scan_stamp_));
}

void PlannerCore::place_laser() {
  const Mount mount = frames_.mount(scan_frame_);
  if (!mount.upright()) throw std::runtime_error("the laser " + scan_frame_ + " must be level and upright");
  Pose laser = mount.planar();
  laser.x -= settings_.rear_axle;
  if (same_place(laser, planner_.laser())) return;
  planner_.change({{"planner/laser_x", std::to_string(laser.x)},
                   {"planner/laser_y", std::to_string(laser.y)},
                   {"planner/laser_yaw", std::to_string(laser.yaw)}});
  outputs_.inform("the laser is at x " + std::to_string(laser.x) + " m, y " + std::to_string(laser.y) +
                  " m, yaw " + std::to_string(laser.yaw) + " rad by tf");
}

void PlannerCore::tick() {
  if (!watch_.clock_runs()) start_anew();
  const double idle = clocks_.steady() - sent_;
  if (scan_is_due() || idle > patience * planner_.control_period()) plan();
  log_.flush();
}

void PlannerCore::plan() {
  const bool scanned = std::exchange(new_scan_, false);
  Pose pose;
  const bool well = planner_.has_path() ? watch_.fresh("scan", in_seconds(scan_stamp_)) &&
                                              watch_.fresh("odometry", in_seconds(odometry_stamp_))
                                        : (watch_.report_consequence("no waypoints yet"), false);
  const bool placed = well && (!scanned || find_pose(pose));
  const std::string fault = watch_.fault();
  if (!fault.empty()) return stop(fault);
  if (!placed) return stop("input");
  if (stopped_by_goal_) return stop("goal speed is 0");
  if (!scanned) return;  // the scan is slightly late; the last command remains valid
  laps_.update(pose, in_seconds(scan_stamp_));
  if (laps_to_drive_ > 0 && laps_.laps() >= laps_to_drive_) return stop("all laps are driven");
  known_ = planner_.update(scan_, pose, speed_, imu_);
  imu_.clear();
  used_ = scan_stamp_;
  ++second_.plans;
  second_.late += known_.update_time > planner_.control_period();
  second_.slowest = std::max(second_.slowest, known_.update_time);
  second_.corrections += known_.corrections;
  second_.min_samples = std::min(second_.min_samples, known_.effective_samples);
  if (!known_.ok) {
    second_.why = known_.status;
    log_("braking: " + std::string(known_.status));
  }
  last_steer_ = known_.steer;
  send(known_.steer, known_.speed);
  latency_.add(clocks_.now() - in_seconds(scan_stamp_));
  outputs_.plan(known_, scan_stamp_);
}

void PlannerCore::stop(const std::string& why) {
  ++second_.stops;
  second_.why = why;
  log_("stopping: " + why);
  send(last_steer_, 0);
}

void PlannerCore::halt() {
  send(last_steer_, 0);
  start_anew();
}

void PlannerCore::send(double steer, double speed) {
  sent_ = clocks_.steady();
  outputs_.drive(steer, speed);
}

Report PlannerCore::report() {
  Report r;
  r.about = "plans";
  r.add("plans", second_.plans);
  r.add("stops", second_.stops);
  r.add("deadlines missed", second_.late);
  r.add("values corrected", second_.corrections);
  r.add("slowest update, ms", 1e3 * second_.slowest);
  r.add("deadline, ms", 1e3 * planner_.control_period());
  if (latency_.count() > 0) {
    r.add("latency from scan to command, p50, ms", 1e3 * latency_.percentile(0.5));
    r.add("latency from scan to command, p99, ms", 1e3 * latency_.percentile(0.99));
  }
  if (laps_.counts()) r.add("laps", laps_.laps());
  if (known_.friction > 0) {
    r.add("friction", known_.friction);
    r.add("friction, standard deviation", known_.friction_deviation);
    r.add("friction that plans rely on", known_.cautious_friction);
    r.add("confidence of the friction", known_.confidence);
    r.add("steering gain", known_.steering_gain);
    r.add("steering delay, ms", 1e3 * known_.delay);
    r.add("slip angle, rad", known_.slip);
  }
  if (second_.plans > 0) r.add("least effective sample size", second_.min_samples);
  r.message = second_.why.empty() ? "driving" : second_.why;
  r.level = second_.stops > 0 || second_.plans == 0    ? Level::error
            : second_.late > 0 || !second_.why.empty() ? Level::warning
                                                       : Level::ok;
  second_ = {};
  return r;
}

}  // namespace slalom_bridge
