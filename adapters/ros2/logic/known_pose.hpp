#pragma once

#include <array>
#include <cstdio>
#include <fstream>
#include <limits>
#include <optional>

#include "logic/transforms.hpp"

/// The last reliable pose of a localiser, from which one that is restarted continues.
namespace slalom::nodes {

/// Poses of the same point of the car at the same time: in the map frame, and in the odometry frame.
struct KnownPose {
  maps::Pose map, odometry;
};

/// The pose in the map frame, if the odometry is `odometry` now: `known`, moved as the odometry has moved
/// since. An odometry that starts again has its origin where the car is. So if it is nearer to its origin
/// than to that of `known`, the car is taken to be where it was.
inline maps::Pose pose_now(const KnownPose& known, const maps::Pose& odometry) {
  const double x = odometry.x - known.odometry.x, y = odometry.y - known.odometry.y;
  if (std::hypot(odometry.x, odometry.y) < std::hypot(x, y)) return known.map;
  const double turn = known.map.yaw - known.odometry.yaw;
  return composed({known.map.x, known.map.y, turn}, {x, y, odometry.yaw});
}

/// Writes a pose and the time (s since 1970) to a file, which has the old or the new content at any time.
/// Returns whether it could be written.
inline bool write_pose(const std::string& file, const KnownPose& pose, double time) {
  const std::string fresh = file + ".new";
  std::ofstream stream(fresh);
  stream.precision(std::numeric_limits<double>::max_digits10);
  const auto& [map, odometry] = pose;
  for (const double each : {map.x, map.y, map.yaw, odometry.x, odometry.y, odometry.yaw, time})
    stream << each << ' ';
  stream << '\n';
  stream.close();
  return stream && std::rename(fresh.c_str(), file.c_str()) == 0;
}

/// The pose in a file, unless a number is not finite or it was not written within the last 10 s.
inline std::optional<KnownPose> read_pose(const std::string& file, double time) {
  std::ifstream stream(file);
  std::array<double, 7> n{};
  for (double& each : n)
    if (!(stream >> each) || !std::isfinite(each)) return std::nullopt;
  constexpr double oldest = 10;  // s
  if (!(n[6] <= time && time - n[6] <= oldest)) return std::nullopt;
  return KnownPose{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

}  // namespace slalom::nodes
