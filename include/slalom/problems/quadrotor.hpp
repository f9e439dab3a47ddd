#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A quadrotor in the vertical plane, and a wall across its way with two gaps.
/// `visit_options` below describes the fields.
struct Quadrotor {
  /// State of the dynamics.
  template <class T>
  struct State {
    T x, z, tilt, speed_x, speed_z, rate;  ///< m, m, rad, m/s, m/s, rad/s
  };
  static constexpr int inputs = 2;  ///< thrust beyond the weight, m/s^2; turning acceleration, rad/s^2
  double dt = 0.05;
  double goal_x = 6, goal_z = 0;
  double wall_from = 2.8, wall_to = 3.2;
  double gap_centre = 1.0, gap_width = 1.0;

  /// State after one step.
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 2>& u) const {
    T s, c;
    sin_cos(x.tilt, s, c);
    const T thrust = T(9.81) + u[0];
    const T speed_x = x.speed_x + T(dt) * thrust * s;
    const T speed_z = x.speed_z + T(dt) * (thrust * c - T(9.81));
    const T rate = x.rate + T(dt) * u[1];
    return {x.x + T(dt) * speed_x, x.z + T(dt) * speed_z, x.tilt + T(dt) * rate, speed_x, speed_z, rate};
  }
  /// Cost of a step.
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 2>& u) const {
    const mask_t<T> hit = hits_wall(x);
    const T effort = T(0.01) * (u[0] * u[0] + u[1] * u[1]);
    return {T(dt) * (distance(x) + T(0.2) * square_speed(x) + effort) + select(hit, T(100), T(0)), hit};
  }
  /// Cost of the last state.
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(3) * distance(x) + T(0.3) * square_speed(x);
  }

  /// Distance to the goal, m.
  template <class T>
  T distance(const State<T>& x) const {
    return sqrt(square(x.x - T(goal_x)) + square(x.z - T(goal_z)));
  }
  /// Weighted sum of the squares of speeds, tilt and turning rate.
  template <class T>
  T square_speed(const State<T>& x) const {
    return x.speed_x * x.speed_x + x.speed_z * x.speed_z + x.tilt * x.tilt + T(0.2) * x.rate * x.rate;
  }
  /// Whether it is in the wall, outside the gaps.
  template <class T>
  mask_t<T> hits_wall(const State<T>& x) const {
    const mask_t<T> in_wall = (x.x > T(wall_from)) & (x.x < T(wall_to));
    return in_wall & (abs(abs(x.z) - T(gap_centre)) > T(gap_width / 2));
  }
};

template <class Parameters, class Visit>
requires is_options_of<Parameters, Quadrotor>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, {"dt", "s", "duration of a step", 0.001, 1});
  visit(p.goal_x, {"goal_x", "m", "goal of the flight, x", -1e+06, 1e+06});
  visit(p.goal_z, {"goal_z", "m", "goal of the flight, z", -1e+06, 1e+06});
  visit(p.wall_from, {"wall_from", "m", "start of the wall along x", -1e+06, 1e+06});
  visit(p.wall_to, {"wall_to", "m", "end of the wall along x", -1e+06, 1e+06});
  visit(p.gap_centre,
        {"gap_centre", "m", "height of one gap's centre above 0, and of the other's below 0", 0, 1e+06});
  visit(p.gap_width, {"gap_width", "m", "height of a gap", 0, 1e+06});
}

}  // namespace slalom::problems
