#pragma once

#include <cmath>
#include <string>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>

#include "bridge/bridge.hpp"
#include "bridge/frames.hpp"
#include "bridge/input_watch.hpp"

/// Conversions between ROS messages and the structs of the bridge.
namespace slalom_ros1 {

using slalom_bridge::Pose;

inline slalom_bridge::Stamp stamp_of(const ros::Time& time) {
  return static_cast<slalom_bridge::Stamp>(time.toNSec());
}
inline ros::Time time_of(slalom_bridge::Stamp stamp) {
  return ros::Time().fromNSec(static_cast<std::uint64_t>(stamp));
}

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

/// The clock of ROS, which can jump, and that of the computer.
inline slalom_bridge::Clocks ros_clocks() {
  return {[] { return ros::Time::now().toSec(); }, [] { return ros::SteadyTime::now().toSec(); }};
}

/// The transforms in a buffer, which must remain valid.
inline slalom_bridge::Frames frames_of(tf2_ros::Buffer& buffer, const std::string& map,
                                       const std::string& base) {
  return {
      [&buffer, map, base](slalom_bridge::Stamp at) { return buffer.canTransform(map, base, time_of(at)); },
      [&buffer, map, base](slalom_bridge::Stamp at) {
        return pose_of(buffer.lookupTransform(map, base, time_of(at)).transform);
      },
      [&buffer, base](const std::string& frame) -> slalom_bridge::Mount {
        if (frame.empty() || frame == base) return {};
        const auto t = buffer.lookupTransform(base, frame, ros::Time(0)).transform;
        return slalom_bridge::mount_of(t.translation.x, t.translation.y, t.translation.z, t.rotation.x,
                                       t.rotation.y, t.rotation.z, t.rotation.w);
      },
      [&buffer] { buffer.clear(); }};
}

inline void warn(const std::string& message) {
  ROS_WARN_STREAM(message);
}
inline void inform(const std::string& message) {
  ROS_INFO_STREAM(message);
}

}  // namespace slalom_ros1
