#pragma once

#include <cmath>
#include <string>

#include <geometry_msgs/Quaternion.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "bridge/bridge.hpp"

/// What ROS messages and our plain structs say in each other's form.
namespace slalom_ros {

inline geometry_msgs::Quaternion quaternion(double yaw) {
  geometry_msgs::Quaternion q;
  q.z = std::sin(yaw / 2);
  q.w = std::cos(yaw / 2);
  return q;
}
inline double yaw_of(const geometry_msgs::Quaternion& q) {
  return std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
}
inline slalom_bridge::Pose pose_of(const geometry_msgs::Pose& p) {
  return {p.position.x, p.position.y, yaw_of(p.orientation)};
}
inline slalom_bridge::Scan scan_of(const sensor_msgs::LaserScan& s) {
  return {s.ranges.data(), s.ranges.size(), s.angle_min, s.angle_increment, s.range_min, s.range_max};
}

/// Whether the scan's count is what its angles promise, to within a beam.
inline bool count_fits(const sensor_msgs::LaserScan& s) {
  const double promised = (static_cast<double>(s.angle_max) - s.angle_min) / s.angle_increment + 1;
  return std::isfinite(promised) && std::abs(promised - static_cast<double>(s.ranges.size())) <= 1.5;
}

/// The reason for a stop, once a second at most.
inline void say(const std::string& why) {
  ROS_WARN_STREAM_THROTTLE(1.0, "stopping: " << why);
}

}  // namespace slalom_ros
