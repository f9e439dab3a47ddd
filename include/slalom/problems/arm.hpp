#pragma once

#include <array>

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// An arm of seven joints that reaches past a ball: over it, under it, or drawn in behind it. Its joints turn
/// about z, y, z, y, z, y, z, from the base on; with all angles 0 it stands upright. Inputs are the joints'
/// rates.
struct Arm {
  static constexpr int joints = 7;  ///< number
  /// State of the dynamics.
  template <class T>
  struct State {
    T angle[joints];  ///< rad
  };
  /// Where the parts of an arm are, m.
  template <class T>
  struct Point {
    T x, y, z;  ///< m
  };
  /// Elbow, wrist and hand.
  template <class T>
  struct Posture {
    Point<T> elbow, wrist, hand;  ///< m, from the base of the arm
  };
  static constexpr int inputs = joints;                                  ///< joint speeds, rad/s
  static constexpr std::array cost_names{"reach", "effort", "contact"};  ///< names of the cost terms
  double dt = 0.05;                                                      ///< duration of a step, s
  double input_min = -1.5, input_max = 1.5;                              ///< joint speeds, rad/s
  double input_rate_max = 10;                                 ///< bound on the rates of the inputs, rad/s^2
  double base = 0.33, upper = 0.32, fore = 0.38, hand = 0.2;  ///< lengths from the ground to the hand, m
  double goal_x = 0.38, goal_y = -0.48, goal_z = 0.34;        ///< for the hand, m
  double ball_x = 0.5, ball_y = 0, ball_z = 0.45, ball_radius = 0.15;  ///< m
  double thickness = 0.06;                                             ///< half of a link's, m

  /// A posture from which the ball is in the way.
  static constexpr std::array<double, joints> start{0.9, 0.5, 0, 1.3, 0, 0.9, 0};

  /// State after one step.
  template <class T>
  State<T> step(const State<T>& x, const Input<T, joints>& u) const {
    State<T> next;
    for (int i = 0; i < joints; ++i) next.angle[i] = x.angle[i] + T(dt) * u[i];
    return next;
  }
  /// Named cost terms of a step.
  template <class T>
  CostTerms<T, 3> stage_cost(const State<T>& x, const Input<T, joints>& u) const {
    const Posture<T> arm = posture(x);
    const mask_t<T> hit = collides(arm);
    T effort(0);
    for (int i = 0; i < joints; ++i) effort = effort + u[i] * u[i];
    return {{T(dt * 40) * distance(arm), T(dt * 0.05) * effort, select(hit, T(100), T(0))}, hit};
  }
  /// Named cost terms of the last state.
  template <class T>
  CostTerms<T, 3> terminal_cost(const State<T>& x) const {
    const Posture<T> arm = posture(x);
    const mask_t<T> hit = collides(arm);
    return {{T(60) * distance(arm), T(0), select(hit, T(100), T(0))}, hit};
  }

  /// Forward kinematics: a frame is turned joint by joint and moved along its own z.
  template <class T>
  Posture<T> posture(const State<T>& s) const {
    Point<T> x{T(1), T(0), T(0)}, y{T(0), T(1), T(0)}, z{T(0), T(0), T(1)};
    turn(x, y, s.angle[0]);
    turn(z, x, s.angle[1]);
    const Point<T> elbow = along({T(0), T(0), T(base)}, z, upper);
    turn(x, y, s.angle[2]);
    turn(z, x, s.angle[3]);
    const Point<T> wrist = along(elbow, z, fore);
    turn(x, y, s.angle[4]);
    turn(z, x, s.angle[5]);
    return {elbow, wrist, along(wrist, z, hand)};
  }
  /// From the hand to the goal, m.
  template <class T>
  T distance(const Posture<T>& arm) const {
    return sqrt(square(arm.hand.x - T(goal_x)) + square(arm.hand.y - T(goal_y)) +
                square(arm.hand.z - T(goal_z)));
  }
  /// Whether a link collides with the ball, or the wrist or the hand with the ground.
  template <class T>
  mask_t<T> collides(const Posture<T>& arm) const {
    const Point<T> shoulder{T(0), T(0), T(base)};
    const T reach(ball_radius + thickness), ground(thickness);
    const T nearest = min(min(square_distance(shoulder, arm.elbow), square_distance(arm.elbow, arm.wrist)),
                          square_distance(arm.wrist, arm.hand));
    return (nearest < reach * reach) | (min(arm.wrist.z, arm.hand.z) < ground);
  }

 private:
  /// Turns two axes of a frame about the third: a towards b.
  template <class T>
  static void turn(Point<T>& a, Point<T>& b, const T& angle) {
    T s, c;
    sin_cos(angle, s, c);
    const Point<T> old = a;
    a = {c * old.x + s * b.x, c * old.y + s * b.y, c * old.z + s * b.z};
    b = {c * b.x - s * old.x, c * b.y - s * old.y, c * b.z - s * old.z};
  }
  template <class T>
  static Point<T> along(const Point<T>& from, const Point<T>& axis, double length) {
    return {from.x + T(length) * axis.x, from.y + T(length) * axis.y, from.z + T(length) * axis.z};
  }
  /// From the ball's centre to the segment from a to b, squared.
  template <class T>
  T square_distance(const Point<T>& a, const Point<T>& b) const {
    const Point<T> way{b.x - a.x, b.y - a.y, b.z - a.z},
        to{T(ball_x) - a.x, T(ball_y) - a.y, T(ball_z) - a.z};
    const T length = square(way.x) + square(way.y) + square(way.z);
    const T part = clamp((way.x * to.x + way.y * to.y + way.z * to.z) / length, T(0), T(1));
    return square(to.x - part * way.x) + square(to.y - part * way.y) + square(to.z - part * way.z);
  }
};

/// Declares the parameters that can be set by name.
template <class Parameters, class Visit>
requires is_options_of<Parameters, Arm>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, Declaration{.name = "dt", .unit = "s", .help = "duration of a step", .min = 0.001, .max = 1});
  visit(p.input_rate_max, Declaration{.name = "input_rate_max",
                                      .unit = "rad/s^2",
                                      .help = "largest acceleration of a joint",
                                      .min = 0,
                                      .max = 1000});
  visit(p.goal_x,
        Declaration{.name = "goal_x", .unit = "m", .help = "where the hand is to go", .min = -10, .max = 10});
  visit(p.goal_y,
        Declaration{.name = "goal_y", .unit = "m", .help = "where the hand is to go", .min = -10, .max = 10});
  visit(p.goal_z,
        Declaration{.name = "goal_z", .unit = "m", .help = "where the hand is to go", .min = -10, .max = 10});
  visit(p.ball_x,
        Declaration{.name = "ball_x", .unit = "m", .help = "centre of the ball", .min = -10, .max = 10});
  visit(p.ball_y,
        Declaration{.name = "ball_y", .unit = "m", .help = "centre of the ball", .min = -10, .max = 10});
  visit(p.ball_z,
        Declaration{.name = "ball_z", .unit = "m", .help = "centre of the ball", .min = -10, .max = 10});
  visit(p.ball_radius,
        Declaration{.name = "ball_radius", .unit = "m", .help = "of the ball", .min = 0, .max = 10});
  visit(p.thickness,
        Declaration{
            .name = "thickness", .unit = "m", .help = "half of the thickness of a link", .min = 0, .max = 1});
}

}  // namespace slalom::problems
