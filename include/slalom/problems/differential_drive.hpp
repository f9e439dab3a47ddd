#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A disc obstacle.
struct Disc {
  double x, y, radius;  ///< m
};

/// A robot with two driven wheels on its way to a goal among discs that it must avoid.
/// `visit_options` below describes the fields.
struct DifferentialDrive {
  /// State of the dynamics.
  template <class T>
  struct State {
    T x, y, yaw;  ///< m, m, rad
  };
  static constexpr int inputs = 2;  ///< speed, m/s; yaw rate, rad/s
  double dt = 0.1;
  double goal_x = 8, goal_y = 0;
  std::array<Disc, 3> discs{
      {{2.5, 0.0, 0.9}, {5.2, 1.0, 0.7}, {5.2, -1.0, 0.7}}};  ///< the discs, with the robot's radius added

  /// State after one step.
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 2>& u) const {
    T s, c;
    sin_cos(x.yaw, s, c);
    return {x.x + T(dt) * u[0] * c, x.y + T(dt) * u[0] * s, x.yaw + T(dt) * u[1]};
  }
  /// Cost of a step.
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 2>& u) const {
    Cost<T> cost = place_cost(x);
    cost.value += T(0.1) * u[1] * u[1];
    return cost;
  }
  /// Cost of the last state.
  template <class T>
  Cost<T> terminal_cost(const State<T>& x) const {
    Cost<T> cost = place_cost(x);
    cost.value += T(5) * distance(x);
    return cost;
  }

  /// Distance to the goal, m.
  template <class T>
  T distance(const State<T>& x) const {
    return sqrt(square(x.x - T(goal_x)) + square(x.y - T(goal_y)));
  }
  /// Cost and collision of a position.
  template <class T>
  Cost<T> place_cost(const State<T>& x) const {
    mask_t<T> inside(false);
    for (const Disc& disc : discs) {
      const T squared = square(x.x - T(disc.x)) + square(x.y - T(disc.y));
      inside = inside | (squared < T(disc.radius * disc.radius));
    }
    return {distance(x) + select(inside, T(100), T(0)), inside};
  }
};

template <class Parameters, class Visit>
requires is_options_of<Parameters, DifferentialDrive>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, {"dt", "s", "duration of a step", 0.001, 1});
  visit(p.goal_x, {"goal_x", "m", "goal of the drive, x", -1e+06, 1e+06});
  visit(p.goal_y, {"goal_y", "m", "goal of the drive, y", -1e+06, 1e+06});
}

}  // namespace slalom::problems
