#pragma once

#include <span>
#include <string>

#include "slalom/maps/pose.hpp"

namespace slalom::maps {

/// Limits of the points and poses that a file or a call gives. They include UTM coordinates; a double
/// resolves 2e-9 m there.
struct PoseLimits {
  static constexpr double position = 1e7;  ///< m, largest magnitude of a coordinate
  static constexpr double yaw = 1e6;       ///< rad, largest magnitude of a yaw
  /// The rule in words, for messages.
  static constexpr const char* rule = "must have x and y within 1e7 m of 0 and a yaw within 1e6 rad";
};

/// Whether a point is finite and within PoseLimits.
inline bool is_plausible(const Point& p) noexcept {
  return std::abs(p.x) <= PoseLimits::position && std::abs(p.y) <= PoseLimits::position;
}
/// Whether a pose is finite and within PoseLimits.
inline bool is_plausible(const Pose& p) noexcept {
  return is_plausible(Point{p.x, p.y}) && std::abs(p.yaw) <= PoseLimits::yaw;
}
/// Throws std::invalid_argument that names `what`, the pose and the rule unless it is plausible.
void check_pose(const std::string& what, const Pose& pose);
/// Throws std::invalid_argument that names the point of `what` and the rule unless all are plausible.
void check_points(const std::string& what, std::span<const Point> points);

}  // namespace slalom::maps
