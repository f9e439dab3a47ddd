#pragma once

#include <filesystem>

#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/lidar.hpp"
#include "slalom/sim/track.hpp"

namespace slalom::testing {

/// A map of the golden data as f1tenth_gym reads it.
inline sim::Track gym_track(const std::filesystem::path& folder, const std::string& map) {
  const auto maps_folder = folder / "maps" / map;
  const auto yaml = std::filesystem::exists(maps_folder / "map.yaml") ? maps_folder / "map.yaml"
                                                                      : maps_folder / (map + ".yaml");
  return sim::Track(maps::load_ros_map(yaml, maps::MapRule::grey_threshold), {}, false);
}

inline sim::LidarOptions gym_lidar() {
  sim::LidarOptions options;
  options.mount = {};
  options.gym = true;
  return options;
}

}  // namespace slalom::testing
