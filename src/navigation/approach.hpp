#pragma once

#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/manoeuvre_search.hpp"
#include "slalom/maps/path_curve.hpp"
#include "slalom/navigation/navigation_problem.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom::navigation::detail {

/// Replaces the yaws of a path but the last by those of the robot on the way to the next pose: the direction
/// of that way, or its opposite where it reverses. It does where the given yaws say so; they count if they
/// differ, and each is within 60 degrees of the direction or its opposite. Otherwise it drives forward; an
/// Ackermann base changes its direction at cusps. A base that cannot reverse drives forward everywhere.
void set_yaws(std::span<maps::Pose> path, const BaseOptions& base) noexcept;

inline maps::Point position(const maps::Pose& pose) {
  return {pose.x, pose.y};
}

inline constexpr double least_way = 1e-3;  ///< m between poses, below which they are at the same place
inline constexpr double aligned =
    0.5;  ///< cosine of the largest angle between a yaw and the path that it is on
/// The index of no point.
inline constexpr std::size_t no_stop = std::numeric_limits<std::size_t>::max();

/// The path that the robot follows, how far it has come, and the part around it for rollouts.
class PathGuide : public maps::PathCurve {
 public:
  /// For plans that reach so far (m), with so much of the path behind the robot and beyond them.
  PathGuide(double reach, double behind);
  double reach() const noexcept { return reach_; }  ///< m, of plans

  /// Sets the part of the leg around the robot in `maps`, to the point `stop` at most. Of a turn `left` (rad)
  /// is left.
  void write(const maps::Pose& robot, double left, std::size_t stop, NavigationMaps& maps) noexcept;

 private:
  double reach_, behind_;    ///< m
  int most_;                 ///< points of the window; they are at least half of `spacing` apart
  maps::CellGrid<4> cells_;  ///< one row: the points of the window
};

/// Begins and ends paths: turns and manoeuvres onto the path, and from the path into the heading at the goal.
class Approach {
 public:
  Approach(const NavigatorOptions& options, const Footprint& footprint);

  /// Makes room for paths of so many poses; those that do not fit are not changed.
  void reserve(std::size_t count) { buffer_.reserve(count); }
  /// Places the robot on a new path.
  void place(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept;
  /// The turn (rad) on the spot to a yaw on which the body is free, the shorter one if both are; 0 if neither
  /// is. A robot that turns already (rad/s) goes on if the other way is hardly shorter.
  double free_turn(const maps::Pose& robot, double yaw, const Costmap& costmap,
                   double rate = 0) const noexcept;
  /// Goes to a point of the path ahead by a manoeuvre. Returns whether there is one.
  bool join(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept;
  /// Goes into the pose of the goal anew, by a manoeuvre that ends straight. Returns false if there is none,
  /// or room to turn to the goal.
  bool dock(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept;
  /// Replaces the end of the path by a manoeuvre into the goal's heading, if there is one.
  void face_goal(PathGuide& guide, const Costmap& costmap) noexcept;
  /// The length of path that a manoeuvre may replace, m.
  double longest_change() const noexcept {
    return 7 * footprint_.circumscribed_radius() + 2 * search_.options().radius;
  }
  void forget() noexcept { begin_ = -1; }  ///< no part of a new path is a manoeuvre
  /// Whether the path with so much left (m) is a manoeuvre, which has to be followed exactly.
  bool manoeuvres(double left) const noexcept { return left <= begin_ && left >= end_; }

 private:
  bool lead(PathGuide& guide, const maps::Pose& robot, std::size_t joint) noexcept;
  bool search(const maps::Pose& start, bool backward_in_time, const Costmap& costmap) noexcept;
  bool search(const PathGuide& guide, const maps::Pose& from, std::size_t first, std::size_t last,
              bool backward_in_time, const Costmap& costmap) noexcept;

  NavigatorOptions options_;
  Footprint footprint_, enlarged_;
  maps::ManoeuvreSearch search_;
  ReservedVector<maps::ManoeuvreGoal> goals_;
  ReservedVector<maps::Pose> buffer_;  ///< a path that is being made
  double begin_ = -1, end_ = 0;        ///< m of path left at the begin and at the end of the last manoeuvre
  std::size_t joint_ = 0;  ///< the point of the path at which the last way that was found meets it
};

}  // namespace slalom::navigation::detail
