#pragma once

#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::testing {

/// A map of the golden data as f1tenth_gym reads it.
inline sim::Track gym_track(const std::filesystem::path& folder, const std::string& map) {
  auto yaml = folder / "maps" / map / "map.yaml";
  if (!std::filesystem::exists(yaml)) yaml.replace_filename(map + ".yaml");
  return sim::Track(maps::load_ros_map(yaml, maps::MapRule::grey_threshold), {}, false);
}

inline sim::LidarOptions gym_lidar() {
  return sim::WorldOptions::gym_compatible().lidar;
}

}  // namespace slalom::testing
