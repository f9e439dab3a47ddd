#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// A point that moves ahead at a constant speed and steers sideways, with a disc on the way that it is to
/// follow: left and right are equally good, and their average is a collision. The smallest problem
/// with two modes; its lateral position is linear in the inputs, so a Gaussian over inputs is one over
/// places.
struct PassingPoint {
  /// State of the dynamics.
  template <class T>
  struct State {
    T x, y;  ///< m; the way is y = 0
  };
  static constexpr int inputs = 1;  ///< speed to the left, m/s
  double dt = 0.2;                  ///< duration of a step, s
  double speed = 1;                 ///< speed ahead, m/s
  double disc_x = 2, disc_y = 0;    ///< centre of the disc, m
  double disc_radius = 0.5;         ///< radius of the disc, m
  double collision_cost = 10;       ///< cost of a step inside the disc
  double way_weight = 0.5;          ///< of the squared distance from the way, 1/m^2
  double input_weight = 0.05;       ///< of the squared input, s^2/m^2

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

/// Declares the parameters that can be set by name.
template <class Parameters, class Visit>
requires is_options_of<Parameters, PassingPoint>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, Declaration{.name = "dt", .unit = "s", .help = "duration of a step", .min = 0.001, .max = 1});
  visit(p.speed, Declaration{.name = "speed", .unit = "m/s", .help = "ahead", .min = 0.01, .max = 100});
  visit(p.disc_x,
        Declaration{.name = "disc_x", .unit = "m", .help = "centre of the disc", .min = -1e3, .max = 1e3});
  visit(p.disc_y, Declaration{.name = "disc_y",
                              .unit = "m",
                              .help = "centre of the disc, left of the way",
                              .min = -1e3,
                              .max = 1e3});
  visit(p.disc_radius,
        Declaration{.name = "disc_radius", .unit = "m", .help = "of the disc", .min = 0, .max = 1e3});
  visit(p.collision_cost,
        Declaration{.name = "collision_cost", .help = "of a step inside the disc", .min = 0, .max = 1e6});
  visit(p.way_weight, Declaration{.name = "way_weight",
                                  .unit = "1/m^2",
                                  .help = "of the distance from the way",
                                  .min = 0,
                                  .max = 1e6});
  visit(p.input_weight,
        Declaration{
            .name = "input_weight", .unit = "s^2/m^2", .help = "of the steering", .min = 0, .max = 1e6});
}

}  // namespace slalom::problems
