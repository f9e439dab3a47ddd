#pragma once

#include "slalom/core/problem.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/navigation/base.hpp"
#include "slalom/navigation/body_check.hpp"
#include "slalom/navigation/cost_options.hpp"
#include "slalom/navigation/costmap.hpp"

namespace slalom::navigation {

/// The maps of a solve, in the map frame, and the goal.
struct NavigationMaps {
  GridView<1> distances;  ///< distances of the costmap
  GridView<1> prices;     ///< prices of the costmap
  /// The part of the path's present leg around the robot. It is looked up at (0, -s), where s (m) is the
  /// length from its beginning: x, y relative to `origin` (m), direction of travel (rad), and s.
  GridView<4> path;
  maps::Point origin;         ///< m, near the robot: states are relative to it
  double progress = 0;        ///< m from the beginning of that part to the robot
  double window_length = 0;   ///< m, of that part
  bool backward = false;      ///< whether the leg is driven in reverse
  bool manoeuvres = false;    ///< whether it is a manoeuvre, to be followed exactly
  bool turns = false;         ///< whether the robot turns on the spot, at `end`
  bool ends_leg = false;      ///< whether that part ends where the leg does
  bool ends_at_goal = false;  ///< whether that part ends at the goal
  maps::Pose end;             ///< end of that part, map frame; a turn ends at exactly this yaw
  /// Rollouts take the body without a rim of so many half cells: that by which it overlaps an obstacle now,
  /// so that they tell a way out, or along it, from one that goes deeper.
  int rim = 0;
  maps::MovingObstaclesView others{};  ///< moving obstacles, map frame
};

/// A robot with a base that follows a path between obstacles to a goal.
template <class Base>
class NavigationProblem {
 public:
  /// State of the dynamics, relative to the origin of the maps.
  template <class T>
  struct State {
    T x, y, yaw;                    ///< m, m, rad
    T progress;                     ///< m along the path in the maps
    T contact;                      ///< 0 until the body is free, then 1, and 2 once it overlaps an obstacle
    Input<T, Base::inputs> before;  ///< m/s, rad/s: the input that is driven
  };
  static constexpr int inputs = Base::inputs;  ///< inputs of a step
  /// Names of the terms of the cost of a step.
  static constexpr std::array cost_names{"progress", "path",         "heading",   "clearance",
                                         "motion",   "goal_heading", "collision", "others"};

  double dt;                             ///< s
  std::array<double, inputs> input_min;  ///< m/s, rad/s
  std::array<double, inputs> input_max;  ///< m/s, rad/s

  /// For a base with these limits and steps of `step` seconds, on costmaps of this resolution (m).
  NavigationProblem(const BaseOptions& limits, const CostOptions& costs, const Footprint& footprint,
                    double resolution, double step)
      : dt(step),
        input_min(Base::per_input(-limits.max_reverse, -limits.max_sideways, -limits.max_turn)),
        input_max(Base::per_input(limits.max_forward, limits.max_sideways, limits.max_turn)),
        base_(limits),
        costs_(weights(costs, step, std::min(per_usual_speed * limits.max_forward, 1.0))),
        step_(step),
        reach_(farthest_projection * step *
               std::max({limits.max_forward, limits.max_reverse, limits.max_sideways})) {
    const auto [forward, sideways, turning] = axis_limits(limits);
    per_braking_ = 0.5 / forward.deceleration;
    per_forward_ = 1 / std::max(limits.max_forward, limits.max_reverse);
    per_sideways_ = 1 / std::max(limits.max_sideways, 0.01);
    const auto axes = Base::per_input(forward, sideways, turning);
    for (std::size_t i = 0; i < axes.size(); ++i)
      axes_[i] = {axes[i].acceleration * step, axes[i].deceleration * step, axes[i].dead_band};
    for (const Footprint& body : footprint.without_rims(0.5 * resolution))
      bodies_.emplace_back(body, resolution);
  }

  /// The input that is driven after `before` if `u` is asked for: it changes within the limits, and what is
  /// in the dead band is not driven. A robot in the dead band stands, and leaves it at once.
  template <class T>
  SLALOM_INLINE_CALLS Input<T, inputs> driven(const Input<T, inputs>& before, Input<T, inputs> u) const {
    if constexpr (turns_while_driving<Base>) {  // the speeds over the ground are within an ellipse
      const T excess = sqrt(square(u[0] * T(per_forward_)) + square(u[1] * T(per_sideways_)));
      for (int i = 0; i < 2; ++i) u[i] = u[i] / max(excess, T(1));
    }
    for (int i = 0; i < inputs; ++i) {
      const Axis& axis = axes_[static_cast<std::size_t>(i)];
      const T was = before[i], faster = T(axis.faster), slower = T(axis.slower), dead = T(axis.dead_band);
      const T high = select(was < T(0), min(was + slower, dead + faster), max(was, dead) + faster);
      const T low =
          select(was > T(0), max(was - slower, T(0) - dead - faster), min(was, T(0) - dead) - faster);
      u[i] = clamp(i + 1 < inputs ? u[i] * T(moves_) : u[i], low, high);
      u[i] = select(abs(u[i]) < dead, T(0), u[i]);
    }
    return u;
  }
  /// The velocity of an input that is driven.
  template <class T>
  SLALOM_INLINE_CALLS VelocityOf<T> velocity(const Input<T, inputs>& u) const {
    return base_.velocity(u);
  }

  /// Sets the maps of the next rollouts, which the maps and the data of their views must outlive.
  void set_maps(const NavigationMaps& maps) noexcept {
    distances_ = maps.distances.relative_to(maps.origin.x, maps.origin.y);
    prices_ = maps.prices.relative_to(maps.origin.x, maps.origin.y);
    path_ = maps.path;
    window_length_ = maps.window_length;
    direction_ = maps.backward ? -1.0 : 1.0;
    end_x_ = maps.end.x - maps.origin.x;
    end_y_ = maps.end.y - maps.origin.y;
    end_yaw_ = maps.end.yaw;
    others_ = maps.others.relative_to(maps.origin);
    body_ = static_cast<std::size_t>(maps.rim);
    // A base that cannot turn on the spot must come to the end of a leg in its direction.
    const bool exact = (steers<Base> && maps.ends_leg) || maps.manoeuvres;
    path_weight_ = exact ? exact_path * static_cast<double>(costs_.path) : static_cast<double>(costs_.path);
    heading_weight_ = maps.turns ? 0.0 : (exact ? exact_heading : 1.0) * static_cast<double>(costs_.heading);
    clearance_weight_ = maps.manoeuvres ? Coefficient(0) : costs_.clearance;  // it was found to be free
    turning_weight_ = (exact ? 0.0 : 1.0) * static_cast<double>(costs_.turning);
    const double pull = maps.turns ? 1 / exact_path : 1.0;
    progress_weight_ = pull * static_cast<double>(costs_.progress);
    final_weight_ = pull * static_cast<double>(costs_.final_progress);
    moves_ = maps.turns ? 0.0 : 1.0;
    turn_weight_ = maps.turns ? costs_.goal_heading : Coefficient(0);
    stop_weight_ = maps.ends_leg && !maps.turns ? costs_.collision : Coefficient(0);
    near_goal_ = maps.ends_at_goal ? Coefficient(1) : Coefficient(0);
  }

  /// The values that the maps hold at a state.
  template <class T>
  struct Seen {
    CellValues<T> foot;              ///< point of the path
    T along, aside;                  ///< m, position from that point along the direction of travel, and left
    T path_sine, path_cosine;        ///< sine and cosine of that direction
    BodyCheck::Contact<T> obstacle;  ///< nearest obstacle
    T price;                         ///< 1 in a priced cell
    T sine, cosine;                  ///< sine and cosine of the yaw
  };
  /// Reads the maps at a state.
  template <class T>
  SLALOM_INLINE_CALLS Seen<T> look_up(const State<T>& x) const {
    Seen<T> seen;
    sin_cos(x.yaw, seen.sine, seen.cosine);
    seen.foot = slalom::look_up(path_, T(0), T(0) - x.progress);
    sin_cos(seen.foot.c, seen.path_sine, seen.path_cosine);
    const T dx = x.x - seen.foot.a, dy = x.y - seen.foot.b;
    seen.along = dx * seen.path_cosine + dy * seen.path_sine;
    seen.aside = dy * seen.path_cosine - dx * seen.path_sine;
    seen.price = slalom::look_up(prices_, x.x, x.y);
    // After a collision it does not matter how far the body is in an obstacle.
    seen.obstacle = bodies_[body_].check(distances_, x.x, x.y, seen.sine, seen.cosine, x.contact < T(1.5));
    return seen;
  }

  /// State after one step. The progress is that of the projection on the path, found anew from the last one.
  template <class T>
  SLALOM_INLINE_CALLS State<T> step(const State<T>& x, const Seen<T>& seen, const Input<T, inputs>& u) const {
    const Input<T, inputs> now = driven(x.before, u);
    const VelocityOf<T> velocity = base_.velocity(now);
    const T forward = velocity.forward * T(step_), left = velocity.left * T(step_);
    const T dx = forward * seen.cosine - left * seen.sine, dy = forward * seen.sine + left * seen.cosine;
    const T projected = seen.foot.d + seen.along + dx * seen.path_cosine + dy * seen.path_sine;
    const T progress = clamp(projected, x.progress - T(reach_), x.progress + T(reach_));
    const T contact = min(select(seen.obstacle.collided, x.contact * T(2), max(x.contact, T(1))), T(2)),
            yaw = x.yaw + velocity.turn * T(step_);
    return {x.x + dx, x.y + dy, yaw, clamp(progress, T(0), T(window_length_)), contact, now};
  }

  /// Cost of step `k`.
  template <class T>
  SLALOM_INLINE_CALLS CostTerms<T, 8> stage_cost(const State<T>& x, const Seen<T>& seen,
                                                 const Input<T, inputs>& u, int k) const {
    const T to_end = sqrt(square(x.x - T(end_x_)) + square(x.y - T(end_y_)));
    const T near = max(T(1) - to_end * T(costs_.per_goal_reach), T(0)) * T(near_goal_);
    const T facing = turns_while_driving<Base> ? near : T(0);
    const T heading_error =
        T(1) - T(direction_) * (seen.cosine * seen.path_cosine + seen.sine * seen.path_sine);
    const T turn_left = abs(x.yaw - T(end_yaw_));
    const VelocityOf<T> velocity = base_.velocity(driven(x.before, u));
    const T hurry = max((abs(velocity.forward) + abs(velocity.left)) * T(per_usual_speed), T(1));
    const T moving = T(costs_.reverse) * max(T(0) - T(direction_) * velocity.forward, T(0)) +
                     T(costs_.sideways) * abs(velocity.left) + T(turning_weight_) * square(velocity.turn) +
                     T(costs_.unknown) * seen.price;
    const Cost<T> met = others_.cost(x.x, x.y, seen.sine, seen.cosine, k);
    return {
        {T(progress_weight_) * left(seen), T(path_weight_) * min(square(seen.aside), T(costs_.max_squared)),
         T(heading_weight_) * (T(1) - facing) * heading_error,
         T(clearance_weight_) * (T(1) - near) * hurry * exp(T(costs_.falloff) * seen.obstacle.clearance),
         moving, (T(turn_weight_) + T(costs_.facing) * facing) * turn_left,
         select(seen.obstacle.collided, T(costs_.collision), T(0)), met.value},
        mask_t<T>(seen.obstacle.collided | met.collided)};
  }

  /// Cost of the last state, with that of a speed from which it cannot stop at the end of a leg.
  template <class T>
  SLALOM_INLINE_CALLS Cost<T> terminal_cost(const State<T>& x, const Seen<T>& seen) const {
    const VelocityOf<T> velocity = base_.velocity(x.before);
    const T rest = left(seen);
    const T stopping = (square(velocity.forward) + square(velocity.left)) * T(per_braking_);
    return {T(final_weight_) * rest + T(stop_weight_) * max(stopping - rest, T(0)), seen.obstacle.collided};
  }

 private:
  /// Factors of weights on an exact path; in a turn on the spot, progress counts by the first one's inverse.
  static constexpr double exact_path = 10, exact_heading = 5;
  static constexpr double per_usual_speed = 2;      ///< s/m; faster robots keep more clearance
  static constexpr double farthest_projection = 3;  ///< largest change of the progress, in ways of a step

  /// Weights times the duration of a step, as rollouts use them.
  struct Weights {
    Coefficient progress, path, heading, clearance, reverse, sideways, turning, unknown, goal_heading, facing,
        collision, final_progress, max_squared, falloff, per_goal_reach;
  };
  /// The clearance costs a slow robot as much on its way as a faster one.
  static Weights weights(const CostOptions& o, double step, double share_of_usual_speed) {
    return {.progress = o.progress * step,
            .path = o.path * step,
            .heading = o.heading * step,
            .clearance = o.clearance * step * share_of_usual_speed,
            .reverse = o.reverse * step,
            .sideways = o.sideways * step,
            .turning = o.turning * step,
            .unknown = o.unknown * step,
            .goal_heading = o.goal_heading * step,
            .facing = 0.5 * o.heading * step,
            .collision = o.collision * step,
            .final_progress = o.final_progress,
            .max_squared = o.path_reach * o.path_reach,
            .falloff = -o.clearance_falloff,
            .per_goal_reach = 1 / o.goal_reach};
  }

  /// m to the end of the window: along the path, and from the side of it.
  template <class T>
  SLALOM_INLINE_CALLS T left(const Seen<T>& seen) const {
    return sqrt(square(T(window_length_) - seen.foot.d - seen.along) + square(seen.aside));
  }

  /// Limits of an input.
  struct Axis {
    Coefficient faster, slower;  ///< m/s or rad/s, largest change in a step: away from 0, and towards it
    Coefficient dead_band;       ///< m/s or rad/s
  };

  Base base_;
  std::array<Axis, static_cast<std::size_t>(inputs)> axes_;
  std::vector<BodyCheck> bodies_;  ///< the body, and those without a rim
  Weights costs_;
  std::size_t body_ = 0;                    ///< the one in use
  Coefficient step_, reach_, per_braking_;  ///< s, m, s^2/m
  Coefficient per_forward_, per_sideways_;  ///< s/m, over the largest speeds
  GridView<1> distances_, prices_;
  GridView<4> path_;
  maps::MovingObstaclesView others_;
  Coefficient window_length_, direction_, end_x_, end_y_, end_yaw_, progress_weight_, final_weight_,
      path_weight_, heading_weight_, clearance_weight_, turning_weight_, turn_weight_, stop_weight_,
      near_goal_;
  Coefficient moves_ = 1;  ///< 0 in a turn on the spot, in which speeds are braked to 0
};

}  // namespace slalom::navigation
