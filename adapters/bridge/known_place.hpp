#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "bridge/bridge.hpp"

/// Where a localiser knew the car to be, so that one that is restarted continues from there.
namespace slalom_bridge {

/// Poses of the same point of the car at the same time: in the map frame, and in the odometry frame.
struct KnownPlace {
  Pose map, odometry;
};

/// The pose in the map frame, if the odometry is `odometry` now: `known`, moved as the odometry has moved
/// since. An odometry that starts again has its origin where the car is. So if it is nearer to its origin
/// than to that of `known`, the car is taken to be where it was.
inline Pose place_now(const KnownPlace& known, const Pose& odometry) {
  const double x = odometry.x - known.odometry.x, y = odometry.y - known.odometry.y;
  if (std::hypot(odometry.x, odometry.y) < std::hypot(x, y)) return known.map;
  const double turn = known.map.yaw - known.odometry.yaw;
  return {known.map.x + x * std::cos(turn) - y * std::sin(turn),
          known.map.y + x * std::sin(turn) + y * std::cos(turn), odometry.yaw + turn};
}

/// A place and the time (s since 1970) as the numbers that nodes keep, and back.
using KnownPlaceNumbers = std::array<double, 7>;
inline KnownPlaceNumbers numbers_of(const KnownPlace& p, double time) {
  return {p.map.x, p.map.y, p.map.yaw, p.odometry.x, p.odometry.y, p.odometry.yaw, time};
}
/// Nothing if a number is not finite, or if the place was written in the future or more than 10 s ago.
inline std::optional<KnownPlace> recent_place(const KnownPlaceNumbers& n, double time) {
  constexpr double most = 10;  // s
  for (const double each : n)
    if (!std::isfinite(each)) return std::nullopt;
  if (!(n[6] <= time && time - n[6] <= most)) return std::nullopt;
  return KnownPlace{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

/// The file has the old or the new content at any time. Returns whether it could be written.
inline bool write_place(const std::string& file, const KnownPlace& place, double time) {
  const std::string fresh = file + ".new";
  std::ofstream stream(fresh);
  stream.precision(std::numeric_limits<double>::max_digits10);
  for (const double each : numbers_of(place, time)) stream << each << ' ';
  stream << '\n';
  stream.close();
  return stream && std::rename(fresh.c_str(), file.c_str()) == 0;
}

/// The place in a file, as `recent_place` has it; nothing if there is none.
inline std::optional<KnownPlace> read_place(const std::string& file, double time) {
  std::ifstream stream(file);
  KnownPlaceNumbers numbers{};
  for (double& each : numbers)
    if (!(stream >> each)) return std::nullopt;
  return recent_place(numbers, time);
}

}  // namespace slalom_bridge
