#pragma once

#include <cmath>
#include <string>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include "bridge/bridge.hpp"
#include "bridge/input_watch.hpp"
#include "bridge/throttled_log.hpp"

/// Conversions between ROS messages and the structs of the bridge.
namespace slalom_ros {

using slalom_bridge::angle_between;
using slalom_bridge::Pose;

inline geometry_msgs::Quaternion quaternion(double yaw) {
  geometry_msgs::Quaternion q;
  q.z = std::sin(yaw / 2);
  q.w = std::cos(yaw / 2);
  return q;
}
inline double yaw_of(const geometry_msgs::Quaternion& q) {
  return std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
}
inline Pose pose_of(const geometry_msgs::Pose& p) {
  return {p.position.x, p.position.y, yaw_of(p.orientation)};
}
inline Pose pose_of(const geometry_msgs::Transform& t) {
  return {t.translation.x, t.translation.y, yaw_of(t.rotation)};
}
inline geometry_msgs::Pose message_of(const Pose& p) {
  geometry_msgs::Pose m;
  m.position.x = p.x;
  m.position.y = p.y;
  m.orientation = quaternion(p.yaw);
  return m;
}
inline geometry_msgs::TransformStamped transform(const Pose& p, const std::string& parent,
                                                 const std::string& child, ros::Time stamp) {
  geometry_msgs::TransformStamped m;
  m.header.stamp = stamp;
  m.header.frame_id = parent;
  m.child_frame_id = child;
  m.transform.translation.x = p.x;
  m.transform.translation.y = p.y;
  m.transform.rotation = quaternion(p.yaw);
  return m;
}
inline slalom_bridge::Scan scan_of(const sensor_msgs::LaserScan& s) {
  return {s.ranges.data(), s.ranges.size(), s.angle_min, s.angle_increment, s.range_min, s.range_max};
}
inline slalom_bridge::Grid grid_of(const nav_msgs::OccupancyGrid& m) {
  return {static_cast<int>(m.info.width), static_cast<int>(m.info.height), m.info.resolution,
          pose_of(m.info.origin), m.data};
}
inline nav_msgs::OccupancyGrid message_of(const slalom_bridge::Grid& g) {
  nav_msgs::OccupancyGrid m;
  m.header.stamp = ros::Time::now();
  m.header.frame_id = "map";
  m.info.width = static_cast<std::uint32_t>(g.width);
  m.info.height = static_cast<std::uint32_t>(g.height);
  m.info.resolution = static_cast<float>(g.resolution);
  m.info.origin = message_of(g.origin);
  m.data = g.cells;
  return m;
}

/// Whether the number of ranges matches the angles of the scan, to within one beam.
inline bool count_fits(const sensor_msgs::LaserScan& s) {
  return slalom_bridge::count_fits(scan_of(s), s.angle_max);
}

/// The clock of ROS, which can jump, and that of the computer.
inline slalom_bridge::Clocks ros_clocks() {
  return {[] { return ros::Time::now().toSec(); }, [] { return ros::SteadyTime::now().toSec(); }};
}

/// A log of warnings.
class ThrottledLog : public slalom_bridge::ThrottledLog {
 public:
  ThrottledLog()
      : slalom_bridge::ThrottledLog(ros_clocks().steady,
                                    [](const std::string& message) { ROS_WARN_STREAM(message); }) {}
};

}  // namespace slalom_ros
