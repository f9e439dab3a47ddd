#pragma once

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "slalom/core/grid_view.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/navigation/base.hpp"
#include "slalom/navigation/cost_options.hpp"
#include "slalom/navigation/costmap.hpp"
#include "slalom/navigation/footprint.hpp"

namespace slalom::navigation {

/// Checks a body against the distances of a costmap, for rollouts. The parts of the footprint decide first:
/// no obstacle is near a part, or one is inside. Where neither is certain for a lane, it looks up the points
/// of the outline of that part, which are at most the edge of a cell apart; the body collides where one of
/// them is in an obstacle cell. So every overlap deeper than half a cell is found, with one exception: a
/// single cell that lies within the body and does not touch its outline. As long as a step is shorter than a
/// cell, a body meets such a cell with its outline first.
class BodyCheck {
 public:
  static constexpr std::size_t max_points = 512;  ///< most points of an outline

  /// For costmaps of this resolution (m). Throws std::invalid_argument if the outline is longer than 512
  /// cells.
  BodyCheck(const Footprint& footprint, double resolution)
      : unsure_(1.42 * resolution), half_cell_(0.5 * resolution) {
    const std::vector<maps::Point> points = footprint.outline_points(resolution);
    if (points.size() > max_points) {
      throw std::invalid_argument("footprint: the outline is " + std::to_string(points.size()) +
                                  " cells long, must be at most 512 cells of the costmap");
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Footprint::Part& part = footprint.parts()[i];
      // A position lies within half of a diagonal (0.71 edges) of the middle of its cell.
      parts_[i] = {
          {part.middle.x, part.middle.y}, part.contained - 0.71 * resolution, part.covering, count, 0};
      for (const maps::Point& point : points)
        if (footprint.part_at(point) == i) points_[count++] = {point.x, point.y};
      parts_[i].end = count;
    }
  }

  /// The values that the maps hold at a pose.
  template <class T>
  struct Contact {
    T clearance;         ///< m, from the body to the nearest obstacle, within about a cell
    mask_t<T> collided;  ///< whether they overlap
  };

  /// Checks the body at (x, y), m, turned by the angle of this sine and cosine.
  template <class T>
  SLALOM_INLINE_CALLS Contact<T> check(const GridView<1>& distances, const T& x, const T& y, const T& sine,
                                       const T& cosine) const {
    T clearance = T(Costmap::reach);
    mask_t<T> collided(false);
    for (const Part& part : parts_) {
      const T distance = look_up_at(distances, part.middle, x, y, sine, cosine);
      const T around = distance - T(part.covering);
      clearance = min(clearance, around);
      collided = collided | (distance < T(part.contained));
      const mask_t<T> unsure = (around < T(unsure_)) & !collided;
      if (any(unsure)) {
        for (std::size_t i = part.begin; i < part.end; ++i)
          collided = collided | (look_up_at(distances, points_[i], x, y, sine, cosine) < T(half_cell_));
      }
    }
    return {max(clearance - T(half_cell_), T(0)), collided};
  }

 private:
  struct Place {
    Coefficient x, y;  ///< m, robot's frame
  };
  struct Part {
    Place middle;
    Coefficient contained;   ///< m; an obstacle whose distance is less is inside
    Coefficient covering;    ///< m
    std::size_t begin, end;  ///< first of its points, and the one after its last
  };

  template <class T>
  SLALOM_INLINE_CALLS static T look_up_at(const GridView<1>& distances, const Place& place, const T& x,
                                          const T& y, const T& sine, const T& cosine) {
    return look_up(distances, x + cosine * T(place.x) - sine * T(place.y),
                   y + sine * T(place.x) + cosine * T(place.y));
  }

  std::array<Part, Footprint::part_count> parts_;
  std::array<Place, max_points> points_;  ///< points of the outline, part by part
  Coefficient unsure_;                    ///< m of clearance below which the outline decides
  Coefficient half_cell_;                 ///< m
};

/// The maps of a solve, in the map frame, and the goal.
struct NavigationMaps {
  GridView<1> distances;  ///< distances of the costmap
  GridView<1> prices;     ///< prices of the costmap
  /// For every cell the nearest point of the path: x, y relative to `origin` (m), yaw (rad),
  /// and length of the path (m) from the beginning of the window.
  GridView<4> path;
  maps::Point origin;                  ///< m, near the robot: states are relative to it
  double window_length = 0;            ///< m, of the path in the window
  bool goal_in_window = false;         ///< whether the path in the window ends at the goal
  maps::Pose goal;                     ///< map frame
  maps::MovingObstaclesView others{};  ///< moving obstacles, map frame
};

/// A robot with a base that follows a path between obstacles to a goal.
template <class Base>
class NavigationProblem {
 public:
  /// State of the dynamics, relative to the origin of the maps.
  template <class T>
  struct State {
    T x, y, yaw;  ///< m, m, rad
  };
  static constexpr int inputs = Base::inputs;  ///< inputs of a step
  /// Names of the terms of the cost of a step.
  static constexpr std::array cost_names{"progress", "path",         "heading",   "clearance",
                                         "motion",   "goal_heading", "collision", "others"};

  double dt;                                  ///< s
  std::array<double, inputs> input_min;       ///< m/s, rad/s
  std::array<double, inputs> input_max;       ///< m/s, rad/s
  std::array<double, inputs> input_rate_max;  ///< m/s^2, rad/s^2

  /// For a base with these limits and steps of `step` seconds, on costmaps of this resolution (m).
  NavigationProblem(const BaseOptions& limits, const CostOptions& costs, const Footprint& footprint,
                    double resolution, double step)
      : dt(step),
        input_min(Base::per_input(-limits.max_reverse, -limits.max_sideways, -limits.max_turn)),
        input_max(Base::per_input(limits.max_forward, limits.max_sideways, limits.max_turn)),
        input_rate_max(
            Base::per_input(limits.max_acceleration, limits.max_acceleration, limits.max_turn_acceleration)),
        base_(limits),
        body_(footprint, resolution),
        costs_(costs, step),
        step_(step) {}

  /// Sets the maps of the next rollouts, which the maps and the data of their views must outlive.
  void set_maps(const NavigationMaps& maps) noexcept {
    distances_ = maps.distances.relative_to(maps.origin.x, maps.origin.y);
    prices_ = maps.prices.relative_to(maps.origin.x, maps.origin.y);
    path_ = maps.path.relative_to(maps.origin.x, maps.origin.y);
    window_length_ = maps.window_length;
    goal_x_ = maps.goal.x - maps.origin.x;
    goal_y_ = maps.goal.y - maps.origin.y;
    goal_sine_ = std::sin(maps.goal.yaw);
    goal_cosine_ = std::cos(maps.goal.yaw);
    others_ = maps.others.relative_to(maps.origin);
    goal_weight_ = maps.goal_in_window ? costs_.goal_heading : Coefficient(0);
  }

  /// The values that the maps hold at a state.
  template <class T>
  struct Seen {
    CellValues<T> foot;              ///< nearest point of the path
    BodyCheck::Contact<T> obstacle;  ///< nearest obstacle
    T price;                         ///< 1 in a priced cell
    T sine, cosine;                  ///< sine and cosine of the yaw
  };
  /// Reads the maps at a state.
  template <class T>
  SLALOM_INLINE_CALLS Seen<T> look_up(const State<T>& x) const {
    Seen<T> seen;
    sin_cos(x.yaw, seen.sine, seen.cosine);
    seen.foot = slalom::look_up(path_, x.x, x.y);
    seen.price = slalom::look_up(prices_, x.x, x.y);
    seen.obstacle = body_.check(distances_, x.x, x.y, seen.sine, seen.cosine);
    return seen;
  }

  /// State after one step.
  template <class T>
  SLALOM_INLINE_CALLS State<T> step(const State<T>& x, const Seen<T>& seen, const Input<T, inputs>& u) const {
    const Motion<T> motion = base_.motion(u);
    const T forward = motion.forward * T(step_), left = motion.left * T(step_);
    return {x.x + forward * seen.cosine - left * seen.sine, x.y + forward * seen.sine + left * seen.cosine,
            x.yaw + motion.turn * T(step_)};
  }

  /// Cost of step `k`.
  template <class T>
  SLALOM_INLINE_CALLS CostTerms<T, 8> stage_cost(const State<T>& x, const Seen<T>& seen,
                                                 const Input<T, inputs>& u, int k) const {
    const OnPath<T> on_path = along_path(x, seen);
    const T to_goal = sqrt(square(x.x - T(goal_x_)) + square(x.y - T(goal_y_)));
    const T near = max(T(1) - to_goal * T(costs_.per_goal_reach), T(0));
    const T goal_error = T(1) - (seen.cosine * T(goal_cosine_) + seen.sine * T(goal_sine_));
    const Motion<T> motion = base_.motion(u);
    const T moving = T(costs_.reverse) * max(T(0) - motion.forward, T(0)) +
                     T(costs_.sideways) * abs(motion.left) + T(costs_.turning) * square(motion.turn) +
                     T(costs_.unknown) * seen.price;
    const Cost<T> met = others_.cost(x.x, x.y, seen.sine, seen.cosine, k);
    return {{T(costs_.progress) * on_path.left, T(costs_.path) * min(on_path.squared, T(costs_.max_squared)),
             T(costs_.heading) * (T(1) - near) * on_path.heading_error,
             T(costs_.clearance) * (T(1) - near) *
                 exp(T(costs_.falloff) * min(seen.obstacle.clearance, T(farthest))),
             moving, T(goal_weight_) * near * goal_error,
             select(seen.obstacle.collided, T(costs_.collision), T(0)), met.value},
            mask_t<T>(seen.obstacle.collided | met.collided)};
  }

  /// Cost of the last state.
  template <class T>
  SLALOM_INLINE_CALLS Cost<T> terminal_cost(const State<T>& x, const Seen<T>& seen) const {
    return {T(costs_.final_progress) * along_path(x, seen).left, seen.obstacle.collided};
  }

 private:
  static constexpr double farthest = 5;  ///< m of clearance; keeps the exponential in range

  /// Weights times the duration of a step, as rollouts use them.
  struct Weights {
    Weights(const CostOptions& o, double step)
        : progress(o.progress * step),
          final_progress(o.final_progress),
          path(o.path * step),
          max_squared(o.path_reach * o.path_reach),
          heading(o.heading * step),
          clearance(o.clearance * step),
          falloff(-o.clearance_falloff),
          reverse(o.reverse * step),
          sideways(o.sideways * step),
          turning(o.turning * step),
          unknown(o.unknown * step),
          goal_heading(o.goal_heading * step),
          per_goal_reach(1 / o.goal_reach),
          collision(o.collision * step) {}
    Coefficient progress, final_progress, path, max_squared, heading, clearance, falloff, reverse, sideways,
        turning, unknown, goal_heading, per_goal_reach, collision;
  };

  template <class T>
  struct OnPath {
    T left;           ///< m to the end of the window: along the path, and from the side of it
    T squared;        ///< m^2, distance from the path
    T heading_error;  ///< 1 - cos(yaw error)
  };
  template <class T>
  SLALOM_INLINE_CALLS OnPath<T> along_path(const State<T>& x, const Seen<T>& seen) const {
    T sine, cosine;
    sin_cos(seen.foot.c, sine, cosine);
    const T dx = x.x - seen.foot.a, dy = x.y - seen.foot.b;
    const T along = T(window_length_) - seen.foot.d - (dx * cosine + dy * sine);
    const T squared = square(dy * cosine - dx * sine);
    return {sqrt(square(along) + squared), squared, T(1) - (seen.cosine * cosine + seen.sine * sine)};
  }

  Base base_;
  BodyCheck body_;
  Weights costs_;
  Coefficient step_;
  GridView<1> distances_, prices_;
  GridView<4> path_;
  maps::MovingObstaclesView others_;
  Coefficient window_length_, goal_x_, goal_y_, goal_sine_, goal_cosine_, goal_weight_;
};

}  // namespace slalom::navigation
