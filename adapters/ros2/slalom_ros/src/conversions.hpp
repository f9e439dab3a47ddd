#pragma once

#include <chrono>

#if __has_include(<tf2/buffer_core.hpp>)
#include <tf2/buffer_core.hpp>
#else
#include <tf2/buffer_core.h>
#endif
#include <builtin_interfaces/msg/time.hpp>
#include <geometry_msgs/msg/pose.hpp>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/path.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

#include "logic/transforms.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/occupancy_grid.hpp"

/// Conversions between the messages of ROS 2 and the structs of the library.
namespace slalom_ros {

namespace maps = slalom::maps;
namespace nodes = slalom::nodes;
using maps::Pose;
using nodes::Stamp;

constexpr std::int64_t second = 1'000'000'000;  ///< ns

inline Stamp stamp_of(const builtin_interfaces::msg::Time& time) {
  return second * time.sec + static_cast<Stamp>(time.nanosec);
}
inline builtin_interfaces::msg::Time time_of(Stamp stamp) {
  builtin_interfaces::msg::Time time;
  time.sec = static_cast<std::int32_t>(stamp / second);
  time.nanosec = static_cast<std::uint32_t>(stamp % second);
  return time;
}

inline geometry_msgs::msg::Quaternion quaternion(double yaw) {
  geometry_msgs::msg::Quaternion q;
  q.z = std::sin(yaw / 2);
  q.w = std::cos(yaw / 2);
  return q;
}
inline double yaw_of(const geometry_msgs::msg::Quaternion& q) {
  return std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
}
inline Pose pose_of(const geometry_msgs::msg::Pose& p) {
  return {p.position.x, p.position.y, yaw_of(p.orientation)};
}
inline geometry_msgs::msg::Pose message_of(const Pose& p) {
  geometry_msgs::msg::Pose m;
  m.position.x = p.x;
  m.position.y = p.y;
  m.orientation = quaternion(p.yaw);
  return m;
}
inline nav_msgs::msg::Path path_of(const std::vector<Pose>& poses, const std::string& frame, Stamp stamp) {
  nav_msgs::msg::Path path;
  path.header.frame_id = frame;
  path.header.stamp = time_of(stamp);
  for (const Pose& pose : poses) {
    path.poses.emplace_back();
    path.poses.back().header = path.header;
    path.poses.back().pose = message_of(pose);
  }
  return path;
}
/// Sets all but the names of the frames.
inline void set_transform(geometry_msgs::msg::TransformStamped& m, const Pose& p, Stamp stamp) {
  m.header.stamp = time_of(stamp);
  m.transform.translation.x = p.x;
  m.transform.translation.y = p.y;
  m.transform.rotation = quaternion(p.yaw);
}

inline maps::LaserScanView scan_of(const sensor_msgs::msg::LaserScan& s) {
  return {s.ranges, static_cast<double>(s.angle_min), static_cast<double>(s.angle_increment),
          static_cast<double>(s.range_min), static_cast<double>(s.range_max)};
}
inline maps::OccupancyGrid grid_of(const nav_msgs::msg::OccupancyGrid& m) {
  using maps::Occupancy;
  maps::OccupancyGrid grid{static_cast<int>(m.info.width),
                           static_cast<int>(m.info.height),
                           static_cast<double>(m.info.resolution),
                           pose_of(m.info.origin),
                           {}};
  for (const std::int8_t cell : m.data)
    grid.cells.push_back(cell < 0 ? Occupancy::unknown : cell >= 50 ? Occupancy::occupied : Occupancy::free);
  return grid;
}
/// The message has no stamp.
inline nav_msgs::msg::OccupancyGrid message_of(const maps::OccupancyGrid& g, const std::string& frame) {
  using maps::Occupancy;
  nav_msgs::msg::OccupancyGrid m;
  m.header.frame_id = frame;
  m.info.width = static_cast<std::uint32_t>(g.width);
  m.info.height = static_cast<std::uint32_t>(g.height);
  m.info.resolution = static_cast<float>(g.resolution);
  m.info.origin = message_of(g.origin);
  for (const Occupancy cell : g.cells)
    m.data.push_back(cell == Occupancy::unknown ? -1 : cell == Occupancy::occupied ? 100 : 0);
  return m;
}

inline nodes::Mount mount_of(const geometry_msgs::msg::Transform& t) {
  return nodes::mount_of(t.translation.x, t.translation.y, t.translation.z, t.rotation.x, t.rotation.y,
                         t.rotation.z, t.rotation.w);
}

/// The transforms in a buffer, which must remain valid.
inline nodes::Transforms transforms_of(tf2::BufferCore& buffer, const std::string& map,
                                       const std::string& base) {
  const auto at = [](Stamp stamp) { return tf2::TimePoint(std::chrono::nanoseconds(stamp)); };
  return {[&buffer, map, base, at](Stamp stamp) { return buffer.canTransform(map, base, at(stamp)); },
          [&buffer, map, base, at](Stamp stamp) {
            return mount_of(buffer.lookupTransform(map, base, at(stamp)).transform).planar();
          },
          [&buffer, base](const std::string& frame) -> nodes::Mount {
            if (frame.empty() || frame == base) return {};
            return mount_of(buffer.lookupTransform(base, frame, tf2::TimePointZero).transform);
          },
          [&buffer] { buffer.clear(); }};
}

}  // namespace slalom_ros
