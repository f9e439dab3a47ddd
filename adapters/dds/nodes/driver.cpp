#include "driver.hpp"

#include <cmath>
#include <cstdio>
#include <exception>
#include <utility>

namespace slalom_ros2 {
namespace {

constexpr double most_apart = 0.1;      // s, between the stamps of a scan and of the odometry it is used with
constexpr double report_interval = 10;  // s
constexpr double patience = 1.6;  // control periods without a command, after which the inputs are checked

}  // namespace

Driver::Driver(const Settings& settings, slalom_bridge::Clocks clocks, Outputs outputs)
    : clocks_(std::move(clocks)),
      outputs_(std::move(outputs)),
      watch_({}, clocks_),
      log_(clocks_.steady, outputs_.log),
      planner_(settings.configuration, settings.method) {
  const auto course = slalom_bridge::load_course(settings.course);
  planner_.change(settings.set);
  planner_.use_path(course.waypoints);
  start_ = course.start;
  if (!settings.map_from_topic) use_map(course.map);
}

void Driver::use_map(const slalom_bridge::Grid& map) {
  localiser_.use_map(map);
  localiser_.start_at(whereabouts());
}

/// Where the car is: the last pose that it drove by, moved as the odometry has moved since.
Pose Driver::whereabouts() const {
  if (!known_) return start_;
  const double turned = known_->yaw - known_odometry_.yaw, c = std::cos(turned), s = std::sin(turned);
  const double dx = odometry_.x - known_odometry_.x, dy = odometry_.y - known_odometry_.y;
  return {known_->x + c * dx - s * dy, known_->y + s * dx + c * dy, odometry_.yaw + turned};
}

/// Discards what was received before the clock jumped.
void Driver::start_anew() {
  last_scan_ = last_odometry_ = 0;
  imu_.clear();
  watch_.forget();
  if (known_) localiser_.start_at(whereabouts());
}

void Driver::hear_map(const slalom_bridge::Grid& map) {
  try {
    use_map(map);
  } catch (const std::exception& error) {
    watch_.report(std::string("map: ") + error.what());
  }
}

void Driver::hear_odometry(double stamp, const Pose& pose, double speed) {
  if (!watch_.accepts("odometry", stamp, last_odometry_)) return;
  if (!std::isfinite(speed)) return watch_.report("the speed of the odometry is not finite");
  if (!watch_.moves_like_a_car(pose, stamp)) return;
  last_odometry_ = stamp;
  odometry_ = pose;
  speed_ = speed;
}

void Driver::hear_imu(double yaw_rate, double forward, double leftward) {
  imu_.add(yaw_rate, forward, leftward);
}

void Driver::hear_other_command() {
  watch_.report("another node commands the car");
}

void Driver::hear_scan(double stamp, const slalom_bridge::Scan& scan, double angle_max) {
  if (!watch_.accepts("scan", stamp, last_scan_)) return stop();
  if (stamp == last_scan_) return;  // it was sent twice
  last_scan_ = stamp;
  if (!slalom_bridge::count_fits(scan, angle_max)) {
    watch_.report("the number of ranges of the scan does not match its angles");
  } else if (!localiser_.has_map()) {
    watch_.report_consequence("no map yet");
  } else if (std::abs(stamp - last_odometry_) > most_apart) {
    watch_.report_consequence("no odometry of the time of the scan");
  } else if (localise(scan, stamp) && watch_.fault().empty()) {
    known_ = pose_;
    known_odometry_ = odometry_;
    const slalom_bridge::Command command = planner_.update(scan, pose_, speed_, imu_);
    imu_.clear();
    report(command);
    if (!command.ok) log_("braking: " + std::string(command.status));
    steer_ = command.steer;
    return send(command.steer, command.speed);
  }
  stop();
}

/// Updates the estimate of the pose, also while the car stops. Returns false and reports the fault if it
/// cannot be used for driving.
bool Driver::localise(const slalom_bridge::Scan& scan, double stamp) {
  const slalom_bridge::Estimate seen = localiser_.update(scan, odometry_, stamp);
  if (!trust_.update(seen)) {
    watch_.report_consequence("localisation: " + trust_.doubt());
    return false;
  }
  pose_ = seen.pose;
  outputs_.transform(seen.odometry_frame);
  return true;
}

/// Once in ten seconds, what is known of car and ground.
void Driver::report(const slalom_bridge::Command& command) {
  if (command.friction == 0 || clocks_.steady() - reported_ < report_interval) return;
  reported_ = clocks_.steady();
  char line[200];
  std::snprintf(
      line, sizeof line,
      "friction %.2f +- %.2f (plans rely on %.2f, confidence %.2f), steering gain %.2f, delay %.0f ms",
      command.friction, command.friction_deviation, command.cautious_friction, command.confidence,
      command.steering_gain, 1e3 * command.delay);
  outputs_.log(line);
}

void Driver::tick() {
  if (!watch_.clock_runs()) start_anew();
  log_.flush();
  if (clocks_.steady() - sent_ < patience * planner_.control_period()) return;
  if (watch_.fresh("scan", last_scan_)) watch_.fresh("odometry", last_odometry_);
  if (!watch_.fault().empty()) stop();
}

void Driver::stop() {
  log_("stopping: " + watch_.fault());
  send(steer_, 0);
}

void Driver::send(double steer, double speed) {
  sent_ = clocks_.steady();
  outputs_.drive(steer, speed);
}

}  // namespace slalom_ros2
