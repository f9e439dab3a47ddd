#pragma once

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "bridge/bridge.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"

/// Conversions between the structs of the bridge and those of the library.
namespace slalom_bridge {

inline Pose plain(const slalom::maps::Pose& p) {
  return {p.x, p.y, p.yaw};
}
inline slalom::maps::Pose pose(const Pose& p) {
  return {p.x, p.y, p.yaw};
}
inline slalom::maps::LaserScanView view(const Scan& s) {
  return {{s.ranges, s.count}, s.angle_min, s.angle_increment, s.range_min, s.range_max};
}
/// The folder from which courses and configurations are searched: bin/ of the first prefix that has them, of
/// the one that the node is installed in (nodes are in share/slalom_ros1) and those of the environment that a
/// sourced ROS 2 sets. Otherwise that of the slalom that the adapter was built against, if it is still there,
/// or the folder of the node.
inline std::filesystem::path program_folder() {
  const auto own = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::filesystem::path> prefixes{own.parent_path().parent_path()};
  for (const char* variable : {"AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"}) {
    const char* const value = std::getenv(variable);
    std::istringstream folders(value ? value : "");
    for (std::string folder; std::getline(folders, folder, ':');) prefixes.emplace_back(folder);
  }
#ifdef SLALOM_BRIDGE_PREFIX
  prefixes.emplace_back(SLALOM_BRIDGE_PREFIX);
#endif
  for (const auto& prefix : prefixes)
    if (std::filesystem::exists(prefix / "share" / "slalom" / "courses")) return prefix / "bin";
  return own;
}
inline std::string rule_of(const slalom::OptionEntry& entry) {
  const std::string type = slalom::type_name(entry);
  return type == "flag" || type == "choice" ? "" : slalom::range_rule(entry.declaration);
}
inline Option plain(const std::string& prefix, const slalom::OptionEntry& entry) {
  const slalom::Declaration& d = entry.declaration;
  return {prefix + d.name,
          slalom::type_name(entry),
          slalom::to_text(entry.value),
          d.unit,
          d.help,
          d.min,
          d.max,
          entry.choices,
          rule_of(entry)};
}

}  // namespace slalom_bridge
