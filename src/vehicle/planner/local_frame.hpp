#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/vehicle_problem.hpp"

namespace slalom::vehicle::detail {

/// The point of the 100 km grid that is nearest to the path's first point, m; (0, 0) for most courses. The
/// planner works relative to it. With UTM coordinates (5e6 m) double resolves 1e-9 m, so every sum would
/// round otherwise than near the origin; the difference to this point is exact.
inline maps::Point grid_origin(std::span<const maps::ReferencePoint> path) {
  constexpr double grid = 1e5;
  if (path.empty() || !std::isfinite(path[0].x) || !std::isfinite(path[0].y)) return {};
  return {grid * std::round(path[0].x / grid), grid * std::round(path[0].y / grid)};
}

/// The path in a frame that begins at `origin` (m).
inline std::vector<maps::ReferencePoint> relative(std::span<const maps::ReferencePoint> path,
                                                  const maps::Point& origin) {
  std::vector<maps::ReferencePoint> made(path.begin(), path.end());
  for (auto& point : made) {
    point.x -= origin.x;
    point.y -= origin.y;
  }
  return made;
}

/// Moves predicted states from that frame to the map frame.
inline void shift(std::span<PredictedState> states, const maps::Point& origin) noexcept {
  for (PredictedState& state : states) {
    state.pose.x += origin.x;
    state.pose.y += origin.y;
  }
}

}  // namespace slalom::vehicle::detail
