#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A pendulum that is turned by a motor too weak to lift it; the angle is measured from upright.
struct Pendulum {
  /// State of the dynamics.
  template <class T>
  struct State {
    T angle, rate;  ///< rad, rad/s
  };
  static constexpr int inputs = 1;  ///< torque, N m
  double dt = 0.02;                 ///< duration of a step, s
  double mass = 1;                  ///< mass at the end of the rod, kg
  double length = 1;                ///< length of the rod, m
  double gravity = 9.81;            ///< acceleration of gravity, m/s^2

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

/// Declares the parameters that can be set by name.
template <class Parameters, class Visit>
requires is_options_of<Parameters, Pendulum>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, Declaration{.name = "dt", .unit = "s", .help = "duration of a step", .min = 1e-3, .max = 1});
  visit(p.mass,
        Declaration{.name = "mass", .unit = "kg", .help = "at the end of the rod", .min = 1e-6, .max = 1e6});
  visit(p.length, Declaration{.name = "length", .unit = "m", .help = "of the rod", .min = 1e-3, .max = 1e3});
  visit(p.gravity,
        Declaration{.name = "gravity", .unit = "m/s^2", .help = "pulls down", .min = 0, .max = 100});
}

}  // namespace slalom::problems
