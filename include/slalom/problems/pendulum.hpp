#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A pendulum that is turned by a motor too weak to lift it; the angle is measured from upright.
/// `visit_options` below describes the fields.
struct Pendulum {
  /// State of the dynamics.
  template <class T>
  struct State {
    T angle, rate;  ///< rad, rad/s
  };
  static constexpr int inputs = 1;  ///< torque, N m
  double dt = 0.02;
  double mass = 1;
  double length = 1;
  double gravity = 9.81;

  /// State after one step.
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    const T rate =
        x.rate + T(dt) * (T(gravity / length) * sin(x.angle) + T(1 / (mass * length * length)) * u[0]);
    return {x.angle + T(dt) * rate, rate};
  }
  /// Cost of a step.
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>& u) const {
    return T(dt) * (T(10) * (T(1) - cos(x.angle)) + T(0.1) * x.rate * x.rate + T(0.01) * u[0] * u[0]);
  }
  /// The square of the energy that is missing to stand, per mass and square length.
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return square(T(0.5) * x.rate * x.rate + T(gravity / length) * (cos(x.angle) - T(1)));
  }
};

template <class Parameters, class Visit>
requires is_options_of<Parameters, Pendulum>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, {"dt", "s", "duration of a step", 1e-3, 1});
  visit(p.mass, {"mass", "kg", "mass at the end of the rod", 1e-6, 1e6});
  visit(p.length, {"length", "m", "length of the rod", 1e-3, 1e3});
  visit(p.gravity, {"gravity", "m/s^2", "acceleration of gravity", 0, 100});
}

}  // namespace slalom::problems
