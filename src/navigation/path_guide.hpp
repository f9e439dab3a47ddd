#pragma once

#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/path_curve.hpp"
#include "slalom/navigation/navigation_problem.hpp"

namespace slalom::navigation::detail {

/// Replaces the yaws of a path but the last by those of the robot on the way to the next pose: the direction
/// of that way, or its opposite where the robot reverses. It reverses where the given yaws say so; they count
/// if they are not all the same, and each is within 60 degrees of the direction or its opposite, on every
/// way. Otherwise it drives forward; an Ackermann base changes its direction of travel at cusps. A base that
/// cannot reverse drives forward everywhere.
void set_yaws(std::span<maps::Pose> path, const BaseOptions& base) noexcept;

inline maps::Point position(const maps::Pose& pose) {
  return {pose.x, pose.y};
}

/// The index of no point.
inline constexpr std::size_t no_stop = std::numeric_limits<std::size_t>::max();

/// The path that the robot follows, how far it has come, and the part around it for rollouts.
class PathGuide : public maps::PathCurve {
 public:
  /// For plans that reach so far (m).
  explicit PathGuide(double reach);
  double reach() const noexcept { return reach_; }  ///< m, of plans

  /// Sets the part of the leg around the robot in `maps`, with its end; it ends at the point `stop` at the
  /// latest. Of a turn `left` (rad) is left.
  void write(const maps::Pose& robot, double left, std::size_t stop, NavigationMaps& maps) noexcept;

 private:
  double reach_;
  maps::CellGrid<4> cells_;  ///< one row: the points of the window
};

}  // namespace slalom::navigation::detail
