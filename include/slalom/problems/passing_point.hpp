#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A point that moves ahead at a constant speed and steers sideways, with a disc on the way that it is to
/// follow: left and right are equally good, and their average is a collision. The smallest problem with two
/// modes; its lateral position is linear in the inputs, so a Gaussian over inputs is one over places.
/// `visit_options` below describes the fields.
struct PassingPoint {
  /// State of the dynamics.
  template <class T>
  struct State {
    T x, y;  ///< m; the way is y = 0
  };
  static constexpr int inputs = 1;  ///< speed to the left, m/s
  double dt = 0.2;
  double speed = 1;
  double disc_x = 2, disc_y = 0;
  double disc_radius = 0.5;
  double collision_cost = 10;
  double way_weight = 0.5;
  double input_weight = 0.05;

  /// State after one step.
  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    return {x.x + T(dt * speed), x.y + T(dt) * u[0]};
  }
  /// Cost of a step.
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 1>& u) const {
    Cost<T> cost = place_cost(x);
    cost.value += T(input_weight) * u[0] * u[0];
    return cost;
  }
  /// Cost of the last state.
  template <class T>
  Cost<T> terminal_cost(const State<T>& x) const {
    return place_cost(x);
  }

  /// Cost and collision of a position.
  template <class T>
  Cost<T> place_cost(const State<T>& x) const {
    const auto inside = square(x.x - T(disc_x)) + square(x.y - T(disc_y)) < T(disc_radius * disc_radius);
    return {T(way_weight) * x.y * x.y + select(inside, T(collision_cost), T(0)), inside};
  }
};

template <class Parameters, class Visit>
requires is_options_of<Parameters, PassingPoint>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, {"dt", "s", "duration of a step", 0.001, 1});
  visit(p.speed, {"speed", "m/s", "speed ahead", 0.01, 100});
  visit(p.disc_x, {"disc_x", "m", "centre of the disc, along the way", -1e3, 1e3});
  visit(p.disc_y, {"disc_y", "m", "centre of the disc, left of the way", -1e3, 1e3});
  visit(p.disc_radius, {"disc_radius", "m", "radius of the disc", 0, 1e3});
  visit(p.collision_cost, {"collision_cost", "", "cost of a step inside the disc", 0, 1e6});
  visit(p.way_weight, {"way_weight", "1/m^2", "weight of the squared distance from the way", 0, 1e6});
  visit(p.input_weight, {"input_weight", "s^2/m^2", "weight of the squared input", 0, 1e6});
}

}  // namespace slalom::problems
