#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A pole on a cart that is pushed: hanging, it has to be swung up within the track. The cart weighs 1 kg,
/// the pole 0.2 kg with its centre at 0.5 m from the hinge; the angle is measured from upright.
/// `visit_options` below describes the fields.
struct CartPole {
  /// State of the dynamics.
  template <class T>
  struct State {
    T position, speed, angle, rate;  ///< m, m/s, rad, rad/s
  };
  static constexpr int inputs = 1;  ///< force on the cart, N
  double dt = 0.02;
  double track = 2;

  /// State after one step.
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    T s, c;
    sin_cos(x.angle, s, c);
    const T push = (u[0] + T(0.1) * x.rate * x.rate * s) / T(1.2);
    const T turn = (T(9.81) * s - c * push) / (T(0.6667) - T(0.0833) * c * c);
    const T speed = x.speed + T(dt) * (push - T(0.0833) * turn * c);
    const T rate = x.rate + T(dt) * turn;
    return {x.position + T(dt) * speed, speed, x.angle + T(dt) * rate, rate};
  }
  /// Cost of a step.
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 1>& u) const {
    const auto off_track = abs(x.position) > T(track);
    const T cost = T(10) * (T(1) - cos(x.angle)) + x.position * x.position + T(0.1) * x.speed * x.speed +
                   T(0.1) * x.rate * x.rate + T(0.001) * u[0] * u[0];
    return {T(dt) * cost + select(off_track, T(100), T(0)), off_track};
  }
  /// Cost of the last state.
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(10) * (T(1) - cos(x.angle)) + x.position * x.position + T(0.1) * x.rate * x.rate;
  }
};

template <class Parameters, class Visit>
requires is_options_of<Parameters, CartPole>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, {"dt", "s", "duration of a step", 0.001, 1});
  visit(p.track, {"track", "m", "length of the track to either side", 0.1, 1000});
}

}  // namespace slalom::problems
