#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"

namespace slalom::problems {

/// An arm of seven joints that reaches past a ball: over it, under it, or drawn in behind it. Its joints turn
/// about z, y, z, y, z, y, z, from the base on; with all angles 0 it stands upright. Inputs are the joints'
/// rates. `visit_options` below describes the fields.
struct Arm {
  static constexpr int joints = 7;  ///< number
  /// State of the dynamics.
  template <class T>
  struct State {
    T angle[joints];  ///< rad
  };
  /// A point of an arm, m.
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
  double dt = 0.05;
  double input_min = -1.5, input_max = 1.5;  ///< joint speeds, rad/s
  double input_rate_max = 10;
  double base = 0.33, upper = 0.32, fore = 0.38, hand = 0.2;  ///< lengths from the ground to the hand, m
  double goal_x = 0.38, goal_y = -0.48, goal_z = 0.34;
  double ball_x = 0.5, ball_y = 0, ball_z = 0.45, ball_radius = 0.15;
  double thickness = 0.06;

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
  /// Distance from the hand to the goal, m.
  template <class T>
  T distance(const Posture<T>& arm) const {
    return sqrt(square(arm.hand.x - T(goal_x)) + square(arm.hand.y - T(goal_y)) +
                square(arm.hand.z - T(goal_z)));
  }
  /// Whether a link collides with the ball, or the wrist or the hand with the ground.
  template <class T>
  SLALOM_INLINE mask_t<T> collides(const Posture<T>& arm) const {
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
  /// Squared distance from the ball's centre to the segment from a to b.
  template <class T>
  SLALOM_INLINE T square_distance(const Point<T>& a, const Point<T>& b) const {
    const Point<T> way{b.x - a.x, b.y - a.y, b.z - a.z},
        to{T(ball_x) - a.x, T(ball_y) - a.y, T(ball_z) - a.z};
    const T length = square(way.x) + square(way.y) + square(way.z);
    const T part = clamp((way.x * to.x + way.y * to.y + way.z * to.z) / length, T(0), T(1));
    return square(to.x - part * way.x) + square(to.y - part * way.y) + square(to.z - part * way.z);
  }
};

template <class Parameters, class Visit>
requires is_options_of<Parameters, Arm>
void visit_options(Parameters& p, Visit&& visit) {
  visit(p.dt, {"dt", "s", "duration of a step", 0.001, 1});
  visit(p.input_rate_max, {"input_rate_max", "rad/s^2", "largest acceleration of a joint", 0, 1000});
  visit(p.goal_x, {"goal_x", "m", "goal of the hand, x", -10, 10});
  visit(p.goal_y, {"goal_y", "m", "goal of the hand, y", -10, 10});
  visit(p.goal_z, {"goal_z", "m", "goal of the hand, z", -10, 10});
  visit(p.ball_x, {"ball_x", "m", "centre of the ball, x", -10, 10});
  visit(p.ball_y, {"ball_y", "m", "centre of the ball, y", -10, 10});
  visit(p.ball_z, {"ball_z", "m", "centre of the ball, z", -10, 10});
  visit(p.ball_radius, {"ball_radius", "m", "radius of the ball", 0, 10});
  visit(p.thickness, {"thickness", "m", "half of the thickness of a link", 0, 1});
}

}  // namespace slalom::problems
