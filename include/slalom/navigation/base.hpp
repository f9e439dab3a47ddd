#pragma once

#include "slalom/core/math.hpp"
#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::navigation {

/// How a base can move.
enum class BaseKind {
  differential,     ///< forward, back, and turning, also on the spot
  omnidirectional,  ///< forward and sideways, and it turns on the spot
  ackermann,        ///< steered wheels: turning only while driving
};
inline const char* const* enum_names(BaseKind) {
  static constexpr const char* const names[] = {"differential", "omnidirectional", "ackermann", nullptr};
  return names;
}

/// A velocity in the robot's frame.
template <class T>
struct VelocityOf {
  static constexpr double largest = 100;  ///< m/s and rad/s, largest magnitude that a navigator takes
  T forward{};                            ///< m/s
  T left{};                               ///< m/s; 0 but for omnidirectional bases
  T turn{};                               ///< rad/s, counter-clockwise
};
/// A velocity as commands and measurements have it.
using Velocity = VelocityOf<double>;

/// The pose after a time (s) with a velocity.
inline maps::Pose moved(const maps::Pose& from, const Velocity& v, double time) noexcept {
  const maps::Pose half{from.x, from.y, from.yaw + 0.5 * time * v.turn};
  const maps::Point at = maps::transform(half, {time * v.forward, time * v.left});
  return {at.x, at.y, from.yaw + time * v.turn};
}

/// Limits of a base. `visit_options` below describes the fields.
struct BaseOptions {
  BaseKind kind = BaseKind::differential;
  double max_forward = 0.5;
  double max_reverse = 0.35;
  double max_sideways = 0.5;
  double max_turn = 1.9;
  double max_acceleration = 2.5;
  double max_deceleration = 0;
  double max_sideways_acceleration = 0;
  double max_sideways_deceleration = 0;
  double max_turn_acceleration = 3.2;
  double max_turn_deceleration = 0;
  double dead_band_forward = 0;
  double dead_band_sideways = 0;
  double dead_band_turn = 0;
  double min_turning_radius = 0.2;
  double delay_forward = 0;
  double delay_sideways = 0;
  double delay_turn = 0;
};

template <class Options, class Visit>
requires is_options_of<Options, BaseOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.kind, {"base", "", "how the base moves"});
  visit(o.max_forward, {"max_forward", "m/s", "largest speed forward", 0.01, 20});
  visit(o.max_reverse, {"max_reverse", "m/s", "largest speed backward", 0, 20});
  visit(o.max_sideways, {"max_sideways", "m/s", "largest speed sideways of an omnidirectional base", 0, 20});
  visit(o.max_turn, {"max_turn", "rad/s", "largest yaw rate; 0: the robot keeps its heading", 0, 20});
  visit(o.max_acceleration,
        {"max_acceleration", "m/s^2", "largest acceleration, also in reverse", 0.01, 100});
  visit(o.max_deceleration, {"max_deceleration", "m/s^2", "largest braking; 0: max_acceleration", 0, 100});
  visit(o.max_sideways_acceleration, {"max_sideways_acceleration", "m/s^2",
                                      "largest acceleration to either side; 0: max_acceleration", 0, 100});
  visit(o.max_sideways_deceleration,
        {"max_sideways_deceleration", "m/s^2",
         "largest braking of it; 0: max_sideways_acceleration, or max_deceleration", 0, 100});
  visit(o.max_turn_acceleration,
        {"max_turn_acceleration", "rad/s^2", "largest increase of the yaw rate", 0.01, 100});
  visit(o.max_turn_deceleration,
        {"max_turn_deceleration", "rad/s^2", "largest decrease of it; 0: max_turn_acceleration", 0, 100});
  visit(o.dead_band_forward, {"dead_band_forward", "m/s", "speed of commands below which it stands", 0, 1});
  visit(o.dead_band_sideways, {"dead_band_sideways", "m/s", "the same for a speed to either side", 0, 1});
  visit(o.dead_band_turn, {"dead_band_turn", "rad/s", "the same for a yaw rate", 0, 1});
  visit(o.min_turning_radius, {"min_turning_radius", "m", "least radius of an Ackermann base", 0.01, 100});
  visit(o.delay_forward,
        {"delay_forward", "s", "dead time plus time constant until a speed forward is driven", 0, 2});
  visit(o.delay_sideways, {"delay_sideways", "s", "the same for a speed to either side", 0, 2});
  visit(o.delay_turn, {"delay_turn", "s", "the same for a yaw rate", 0, 2});
}

/// Whether a base can turn without driving.
inline bool turns_on_the_spot(const BaseOptions& base) noexcept {
  return base.kind != BaseKind::ackermann && base.max_turn > 0;
}

/// The limits of an axis.
struct AxisLimits {
  double acceleration, deceleration;  ///< m/s^2 or rad/s^2: away from 0, and towards it
  double dead_band;                   ///< m/s or rad/s
};
/// The limits of the axes forward, sideways and turning.
inline std::array<AxisLimits, 3> axis_limits(const BaseOptions& base) noexcept {
  const auto given = [](double value, double otherwise) { return value > 0 ? value : otherwise; };
  const double braking = given(base.max_deceleration, base.max_acceleration);
  const double sideways = given(base.max_sideways_acceleration, base.max_acceleration);
  return {{{base.max_acceleration, braking, base.dead_band_forward},
           {sideways,
            given(base.max_sideways_deceleration,
                  base.max_sideways_acceleration > 0 ? base.max_sideways_acceleration : braking),
            base.dead_band_sideways},
           {base.max_turn_acceleration, given(base.max_turn_deceleration, base.max_turn_acceleration),
            base.dead_band_turn}}};
}

/// The inputs of a base that turns on the spot: the speed forward, with three inputs also to the left (m/s),
/// and the yaw rate (rad/s).
template <int count>
struct TurningBase {
  static constexpr int inputs = count;  ///< inputs of a step
  /// Does not use the limits: the problem takes them as bounds of the inputs.
  explicit TurningBase(const BaseOptions&) {}
  /// The velocity of an input.
  template <class T>
  SLALOM_INLINE_CALLS VelocityOf<T> velocity(const Input<T, count>& u) const {
    return {u[0], count == 3 ? u[1] : T(0), u[count - 1]};
  }
  /// The input of a velocity.
  static Input<double, count> input(const Velocity& v) {
    if constexpr (count == 3)
      return {{v.forward, v.left, v.turn}};
    else
      return {{v.forward, v.turn}};
  }
  /// Selects the values of the inputs from those of the axes forward, sideways and turning.
  template <class Value>
  static std::array<Value, count> per_input(const Value& forward, const Value& left, const Value& turn) {
    if constexpr (count == 3)
      return {forward, left, turn};
    else
      return {forward, turn};
  }
};
using DifferentialBase = TurningBase<2>;     ///< forward, back, and turning
using OmnidirectionalBase = TurningBase<3>;  ///< sideways, too

/// The inputs of an Ackermann base: speed (m/s), and yaw rate (rad/s), which the turning radius limits.
struct AckermannBase : DifferentialBase {
  /// Takes the smallest turning radius from the limits.
  explicit AckermannBase(const BaseOptions& limits)
      : DifferentialBase(limits), largest_curvature_(1 / limits.min_turning_radius) {}
  /// The velocity of an input.
  template <class T>
  SLALOM_INLINE_CALLS VelocityOf<T> velocity(const Input<T, 2>& u) const {
    const T most = abs(u[0]) * T(largest_curvature_);
    return {u[0], T(0), clamp(u[1], T(0) - most, most)};
  }

 private:
  Coefficient largest_curvature_;  ///< 1/m
};

/// Whether a base turns while it goes anywhere.
template <class Base>
inline constexpr bool turns_while_driving = Base::inputs == 3;
/// Whether a base turns only while it drives.
template <class Base>
inline constexpr bool steers = std::is_same_v<Base, AckermannBase>;

}  // namespace slalom::navigation
