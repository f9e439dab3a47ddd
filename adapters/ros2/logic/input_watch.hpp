#pragma once

#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"

/// The checks that a driving node makes of its inputs; a fault stops the car.
namespace slalom::nodes {

/// A duration in seconds, rounded for messages.
inline std::string seconds(double value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.2f s", value);
  return text;
}
/// A distance in metres, rounded for messages.
inline std::string metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g m", value);
  return text;
}

/// Whether the number of ranges matches the angles of the scan, to within one beam.
inline bool count_fits(const maps::LaserScanView& scan, double angle_max) {
  const double promised = (angle_max - scan.angle_min) / scan.angle_increment + 1;
  return std::isfinite(promised) && std::abs(promised - static_cast<double>(scan.ranges.size())) <= 1.5;
}

/// The clocks of a node; both return seconds.
struct Clocks {
  std::function<double()> now;     ///< the clock of the stamps; it may jump
  std::function<double()> steady;  ///< the clock of the computer; it never jumps
};

/// The limits that the inputs of a driving node must keep.
struct WatchLimits {
  double max_age = 0.15;      ///< s, age of a scan or an odometry
  double max_future = 0.05;   ///< s, that a stamp may be in the future
  double settle_time = 0.25;  ///< s, that the car stays stopped after a fault
  double jump = 0.3;          ///< m, beyond what the car can have driven, or rad
  double max_speed = 12;      ///< m/s
  double max_turn = 12;       ///< rad/s
};

/// Checks the inputs of a driving node. Any fault stops the car until `settle_time` after it last occurred;
/// then the car continues by itself. Stamps are in seconds; a stamp of 0 means that there is none.
class InputWatch {
 public:
  InputWatch(const WatchLimits& limits, Clocks clocks) : limits_(limits), clocks_(std::move(clocks)) {}

  /// Reports a fault.
  void report(const std::string& reason) {
    reason_ = reason;
    at_ = caused_at_ = clocks_.steady();
  }
  /// Reports a fault that can be the consequence of another one. A fault reported recently remains the
  /// reason, for longer than the interval between messages of the log.
  void report_consequence(const std::string& reason) {
    constexpr double lately = 1.2;  // s
    if (clocks_.steady() - caused_at_ > lately) reason_ = reason;
    at_ = clocks_.steady();
  }
  /// The last fault until it has settled; otherwise empty.
  std::string fault() const { return clocks_.steady() - at_ < limits_.settle_time ? reason_ : ""; }

  /// Whether the clock of the stamps has advanced like the steady one since the last call. After a jump
  /// earlier stamps are discarded.
  bool clock_runs() {
    const double now = clocks_.now(), steady = clocks_.steady();
    const std::optional<Moment> last = std::exchange(last_moment_, Moment{now, steady});
    if (!last) return true;
    const double gone = now - last->now, really = steady - last->steady;
    if (std::abs(gone - really) < 0.5) return true;
    report("the clock jumped by " + seconds(gone - really));
    return false;
  }

  /// Whether the stamp of a message is valid; otherwise reports the fault. `last`: the newest stamp used.
  bool accepts(const char* what, double stamp, double last) {
    const double age = clocks_.now() - stamp;
    if (!(age >= -limits_.max_future))
      report(std::string(what) + " from the future, by " + seconds(-age));
    else if (last != 0 && stamp < last)
      report(std::string(what) + " out of order");
    else if (age > limits_.max_age)
      report(std::string(what) + " late by " + seconds(age));
    else
      return true;
    return false;
  }

  /// Whether an input is recent enough; otherwise reports the fault, unless its cause is known.
  bool fresh(const char* what, double stamp) {
    const double age = clocks_.now() - stamp;
    if (stamp != 0 && age <= limits_.max_age) return true;
    report_consequence(std::string("no ") + what + (stamp == 0 ? " yet" : " for " + seconds(age)));
    return false;
  }

  /// Whether the car can have moved here from its last pose; otherwise reports the fault.
  bool moves_like_a_car(const maps::Pose& pose, double stamp) {
    if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw)) {
      report("pose is not finite");
      return false;
    }
    bool plausible = true;
    if (last_pose_) {
      const double dt = std::max(0.0, stamp - last_pose_stamp_);
      const double way = std::hypot(pose.x - last_pose_->x, pose.y - last_pose_->y);
      const double turn = std::abs(maps::wrap_angle(pose.yaw - last_pose_->yaw));
      plausible = dt > 0.5 || (way < limits_.max_speed * dt + limits_.jump &&
                               turn < limits_.max_turn * dt + limits_.jump);
      if (!plausible) report("pose jumped by " + metres(way));
    }
    last_pose_ = pose;
    last_pose_stamp_ = stamp;
    return plausible;
  }

  /// Forgets the last pose.
  void forget() { last_pose_.reset(); }

 private:
  struct Moment {
    double now = 0, steady = 0;  ///< s
  };

  WatchLimits limits_;
  Clocks clocks_;
  std::string reason_;
  double at_ = -1e9, caused_at_ = -1e9;  ///< s, steady clock
  std::optional<Moment> last_moment_;
  std::optional<maps::Pose> last_pose_;
  double last_pose_stamp_ = 0;  ///< s
};

}  // namespace slalom::nodes
