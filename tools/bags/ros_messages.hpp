#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"

/// Messages of ROS 1 as they are serialised (http://wiki.ros.org/msg): fields one after the other,
/// little-endian, texts and lists behind their number. What is not needed is left out. All functions throw
/// std::invalid_argument on bytes that do not fit the type.
namespace slalom::tools::ros {

struct Header {
  double stamp = 0;  ///< s
  std::string frame;
};

/// sensor_msgs/LaserScan
struct Scan {
  Header header;
  maps::LaserScanView shape;  ///< without the ranges
  std::vector<float> ranges;
};
Scan scan(std::string_view bytes);

/// nav_msgs/Odometry
struct Odometry {
  Header header;
  maps::Pose pose;
  double speed = 0;  ///< m/s, forwards
};
Odometry odometry(std::string_view bytes);

/// ackermann_msgs/AckermannDriveStamped
struct Drive {
  Header header;
  double steer = 0, speed = 0;  ///< rad, m/s
};
Drive drive(std::string_view bytes);

/// nav_msgs/OccupancyGrid
maps::OccupancyGrid map(std::string_view bytes);

/// waypoint_msg/Waypoint
struct Waypoint {
  maps::Pose pose;
  double speed = 0;  ///< m/s
};
std::vector<Waypoint> waypoints(std::string_view bytes);

/// tf2_msgs/TFMessage
struct Transform {
  std::string parent, child;
  maps::Pose pose;  ///< pose of the child in the parent
};
std::vector<Transform> transforms(std::string_view bytes);

}  // namespace slalom::tools::ros
