#pragma once

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "bridge/bridge.hpp"

/// The last reliable pose of a car in a file, from which a localiser that is restarted continues.
namespace slalom_bridge {

/// Writes the pose and the time (s since 1970). The file has the old or the new content at any time. Returns
/// whether it could be written.
inline bool write_pose(const std::string& file, const Pose& pose, double time) {
  const std::string fresh = file + ".new";
  std::ofstream stream(fresh);
  stream.precision(std::numeric_limits<double>::max_digits10);
  stream << pose.x << ' ' << pose.y << ' ' << pose.yaw << ' ' << time << '\n';
  stream.close();
  return stream && std::rename(fresh.c_str(), file.c_str()) == 0;
}

/// The pose in a file, unless there is none or it is more than `max_age` (s) older than `time`, or newer.
inline std::optional<Pose> read_pose(const std::string& file, double time, double max_age) {
  std::ifstream stream(file);
  Pose pose;
  double written = 0;
  if (!(stream >> pose.x >> pose.y >> pose.yaw >> written)) return std::nullopt;
  if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw)) return std::nullopt;
  if (!(written <= time && time - written <= max_age)) return std::nullopt;
  return pose;
}

}  // namespace slalom_bridge
