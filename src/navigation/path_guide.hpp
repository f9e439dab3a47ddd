#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/navigation/navigation_problem.hpp"

namespace slalom::navigation::detail {

/// The path that the robot follows, how far it has come, and the map of the path's nearest points around it.
class PathGuide {
 public:
  static constexpr double spacing = 0.05;  ///< m, about, between points

  /// For plans that reach so far (m).
  explicit PathGuide(double reach);

  /// Takes a path through these points, with points at a constant distance, which ends at `goal`. There must
  /// be at least one point; more points than `reserve` was called for allocate.
  void set(std::span<const maps::Point> points, const maps::Pose& goal) noexcept;
  /// Makes room for paths of so many points.
  void reserve(std::size_t count) { path_.reserve(count); }
  void clear() noexcept { path_.clear(); }
  bool empty() const noexcept { return path_.empty(); }
  /// The goal and the direction at each point; the last point is the goal.
  std::span<const maps::Pose> points() const noexcept { return path_; }
  const maps::Pose& goal() const noexcept { return goal_; }

  /// Moves on to the point nearest to the robot, among those 0.3 m back and 2 m ahead.
  void advance(const maps::Point& robot) noexcept;
  std::size_t nearest() const noexcept { return nearest_; }  ///< index of that point
  double step() const noexcept { return step_; }             ///< m, between points
  /// The number of points that a length (m) of path takes, rounded up.
  std::size_t points_for(double length) const noexcept {
    return saturate_cast<std::size_t>(length / std::max(step_, 1e-3)) + 1;
  }
  /// Length of the path from the nearest point on, m.
  double remaining() const noexcept {
    return path_.empty() ? 0 : step_ * static_cast<double>(path_.size() - 1 - nearest_);
  }

  /// Computes the map around the robot, and sets it, the window and the goal in `maps`.
  void write(const maps::Point& robot, NavigationMaps& maps) noexcept;

 private:
  double reach_;
  maps::Pose goal_;
  ReservedVector<maps::Pose> path_;
  double step_ = spacing;
  std::size_t nearest_ = 0;
  maps::ReferenceField field_;  ///< field of the window, with indices into it in the place of speeds
  maps::CellGrid<4> cells_;
  ReservedVector<maps::ReferencePoint> window_;
};

}  // namespace slalom::navigation::detail
