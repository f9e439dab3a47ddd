#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "conversions.hpp"

/// Checks the inputs of a driving node. Any fault stops the car until `settle_time` after it last occurred;
/// then the car continues by itself.
namespace slalom_ros {

struct WatchLimits {
  double max_age = 0.15;      ///< s, of a scan or an odometry
  double max_future = 0.05;   ///< s, that a stamp may be in the future
  double settle_time = 0.25;  ///< s
  double jump = 0.3;          ///< m, beyond what the car can have driven, or rad
  double max_speed = 12;      ///< m/s
  double max_turn = 12;       ///< rad/s
};

class InputWatch {
 public:
  explicit InputWatch(const WatchLimits& limits) : limits_(limits) {}

  void report(const std::string& reason) {
    reason_ = reason;
    at_ = caused_at_ = wall();
  }
  /// Reports a fault that can be the consequence of another one. A fault reported recently remains the
  /// reason, for longer than the interval between messages of the log.
  void report_consequence(const std::string& reason) {
    constexpr double lately = 1.2;  // s
    if (wall() - caused_at_ > lately) reason_ = reason;
    at_ = wall();
  }
  /// The last fault until it has settled; otherwise empty.
  std::string fault() const { return wall() - at_ < limits_.settle_time ? reason_ : ""; }

  /// Whether the ROS clock has advanced like the system clock since the last call. After a jump of the clock
  /// earlier stamps are discarded.
  bool clock_runs() {
    const double now = ros::Time::now().toSec(), steady = wall();
    const double gone = now - clock_, really = steady - clock_wall_;
    const bool first = clock_wall_ == 0;
    clock_ = now;
    clock_wall_ = steady;
    if (first || std::abs(gone - really) < 0.5) return true;
    report(std::string("the clock jumped by ") + seconds(gone - really));
    return false;
  }

  /// Whether the stamp of a message is valid; otherwise reports the fault. `last` is the newest stamp used so
  /// far.
  bool accepts(const char* what, ros::Time stamp, ros::Time last) {
    const double age = (ros::Time::now() - stamp).toSec();
    if (age < -limits_.max_future)
      report(std::string(what) + " from the future, by " + seconds(-age));
    else if (!last.isZero() && stamp < last)
      report(std::string(what) + " out of order");
    else if (age > limits_.max_age)
      report(std::string(what) + " late by " + seconds(age));
    else
      return true;
    return false;
  }

  /// Whether an input is recent enough; otherwise reports the fault, unless its cause is known.
  bool fresh(const char* what, ros::Time stamp) {
    const double age = (ros::Time::now() - stamp).toSec();
    if (!stamp.isZero() && age <= limits_.max_age) return true;
    report_consequence(std::string("no ") + what + (stamp.isZero() ? " yet" : " for " + seconds(age)));
    return false;
  }

  /// Whether the car can have moved here from its last pose; otherwise reports the fault.
  bool moves_like_a_car(const Pose& pose, ros::Time stamp) {
    if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw)) {
      report("pose is not finite");
      return false;
    }
    bool plausible = true;
    if (last_pose_) {
      const double dt = std::max(0.0, (stamp - last_pose_stamp_).toSec());
      const double way = std::hypot(pose.x - last_pose_->x, pose.y - last_pose_->y);
      const double turn = angle_between(pose.yaw, last_pose_->yaw);
      plausible = dt > 0.5 || (way < limits_.max_speed * dt + limits_.jump &&
                               turn < limits_.max_turn * dt + limits_.jump);
      if (!plausible) report("pose jumped by " + std::to_string(way) + " m");
    }
    last_pose_ = pose;
    last_pose_stamp_ = stamp;
    return plausible;
  }

  void forget() { last_pose_.reset(); }

 private:
  static double wall() { return ros::SteadyTime::now().toSec(); }

  WatchLimits limits_;
  std::string reason_;
  double at_ = -1e9, caused_at_ = -1e9, clock_ = 0, clock_wall_ = 0;  ///< s
  std::optional<Pose> last_pose_;
  ros::Time last_pose_stamp_;
};

}  // namespace slalom_ros
