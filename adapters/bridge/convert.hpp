#pragma once

#include <filesystem>
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
/// The folder from which courses and configurations are searched: bin/ of the prefix that the node is
/// installed in (nodes are in share/slalom_ros1), otherwise the folder of the node.
inline std::filesystem::path program_folder() {
  const auto own = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const auto prefix = own.parent_path().parent_path();
  return std::filesystem::exists(prefix / "share" / "slalom" / "courses") ? prefix / "bin" : own;
}
inline Option plain(const std::string& prefix, const slalom::OptionEntry& entry) {
  const slalom::Declaration& d = entry.declaration;
  return {
      prefix + d.name, slalom::type_name(entry), slalom::to_text(entry.value), d.unit, d.help, d.min, d.max,
      entry.choices};
}

}  // namespace slalom_bridge
