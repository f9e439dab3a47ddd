#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::tools {

/// The data at the time of a scan, and the command that followed.
struct BagTick {
  double time = 0;            ///< s since the first scan
  maps::LaserScanView shape;  ///< shape of the scan, without its ranges
  std::vector<float> ranges;
  vehicle::Odometry odometry;  ///< pose as localised, map frame; speed as the wheels say
  slalom::Command command;
};

/// A drive of a car, from a bag that adapters/ros1/launch/record.launch has recorded.
struct BagDrive {
  std::vector<BagTick> ticks;  ///< scans for which pose, speed and command are known
  int left_out = 0;            ///< other scans
  std::optional<maps::OccupancyGrid> map;
  std::vector<vehicle::Waypoint> path;  ///< empty if the bag holds none
  std::optional<maps::Pose> laser;      ///< from the rear axle
};

/// Throws IoError if the file is not a bag (see read_bag), and on wrong message types and missing topics.
BagDrive load_bag_drive(const std::string& file);

}  // namespace slalom::tools
