#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// The sideways force of a tyre over its slip angle.
enum class TyreModel {
  linear,      ///< proportional to the slip angle, without bound
  saturating,  ///< Pacejka's curve: no more than friction times load, shared with drive and brakes
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(TyreModel) {
  static constexpr const char* const names[] = {"linear", "saturating", nullptr};
  return names;
}

/// What plans seek.
enum class Objective {
  path_speed,  ///< the speeds of the path, which plans do not exceed
  lap_time,    ///< the shortest time within grip and `max_speed`, whatever the speeds of the path
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(Objective) {
  static constexpr const char* const names[] = {"path_speed", "lap_time", nullptr};
  return names;
}

/// Options of `vehicle.model: single_track`. The defaults are the 1/10-scale car of f1tenth_gym.
struct SingleTrackOptions {
  Objective objective = Objective::path_speed;  ///< what plans seek
  TyreModel tyres = TyreModel::saturating;      ///< sideways force over slip angle
  double friction = 1.0489;                     ///< mu, between tyre and road
  double cornering_front = 4.718;  ///< C_Sf, 1/rad, cornering stiffness over friction and axle load
  double cornering_rear = 5.4562;  ///< C_Sr, 1/rad
  double gravity_height = 0.074;   ///< h, m, of the centre of gravity
  double mass = 3.74;              ///< m, kg
  /// I_z, kg m^2, about the vertical axis; sqrt(inertia / mass) must be 0.1 to 1 wheelbase
  double inertia = 0.04712;
  double steer_rate = 3.2;          ///< rad/s, at which the wheels turn at most
  double half_steer_speed = 5;      ///< m/s, at which the input steers half as much as at a standstill
  double switch_speed = 7.319;      ///< m/s, above it the motor's power limits the acceleration
  double speed_gain = 4.755;        ///< 1/s, acceleration per error of speed of the car's own speed control
  double brake_gain = 19.02;        ///< 1/s, the same when braking
  double usable_grip = 0.9;         ///< share of friction times gravity that a plan may use
  double speed_share = 1;           ///< with `lap_time`: plans drive at most at this share of the speeds that
                                    ///< a point mass with the usable grip drives along the path
  double braking_share = 1;         ///< share of the usable grip that the mean deceleration of a step may use
  double grip_weight = 300;         ///< cost of the square of the share above `usable_grip`
  double friction_deviation = 0.1;  ///< of the logarithm of the friction in the variants of the world
  double cornering_deviation = 0.1;   ///< the same of the cornering stiffness
  double collision_ahead_cost = 100;  ///< cost of a plan that ends where the car cannot stop before an
                                      ///< obstacle, times the share of its energy that is left there

  /// Whether all values are equal.
  bool operator==(const SingleTrackOptions&) const = default;
};

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, SingleTrackOptions>
void visit_options(Options& o, Visit&& visit) {
  const auto number = [&](auto& field, const char* name, const char* symbol, const char* unit,
                          const char* help, double min, double max) {
    visit(field,
          Declaration{.name = name, .symbol = symbol, .unit = unit, .help = help, .min = min, .max = max});
  };
  visit(o.objective, Declaration{.name = "objective",
                                 .help = "model `single_track`: what plans seek: the speeds of the path, or "
                                         "the shortest time within grip and max_speed"});
  visit(o.tyres,
        Declaration{.name = "tyres", .help = "model `single_track`: sideways force over slip angle"});
  number(o.friction, "friction", "mu", "", "model `single_track`: between tyre and road", 0.05, 3);
  number(o.cornering_front, "cornering_front", "C_Sf", "1/rad",
         "model `single_track`: cornering stiffness of the front tyres over friction and load", 0.1, 100);
  number(o.cornering_rear, "cornering_rear", "C_Sr", "1/rad",
         "model `single_track`: the same of the rear tyres", 0.1, 100);
  number(o.gravity_height, "gravity_height", "h", "m",
         "model `single_track`: height of the centre of gravity", 0, 3);
  number(o.mass, "mass", "m", "kg", "model `single_track`: mass of the car", 1e-3, 1e5);
  number(o.inertia, "inertia", "I_z", "kg m^2", "model `single_track`: about the vertical axis", 1e-6, 1e6);
  number(o.steer_rate, "steer_rate", "", "rad/s", "model `single_track`: rate of the wheels' angle at most",
         1e-2, 100);
  number(o.half_steer_speed, "half_steer_speed", "", "m/s",
         "model `single_track`: speed at which an input steers half as much as at a standstill", 0.1, 1000);
  number(o.switch_speed, "switch_speed", "", "m/s",
         "model `single_track`: speed above which the motor's power limits the acceleration", 0.1, 100);
  number(o.speed_gain, "speed_gain", "", "1/s",
         "model `single_track`: acceleration per error of speed of the car's speed control", 0.1, 1000);
  number(o.brake_gain, "brake_gain", "", "1/s", "model `single_track`: the same when braking", 0.1, 1000);
  number(o.usable_grip, "usable_grip", "", "",
         "model `single_track`: share of friction times gravity that a plan may use", 0.05, 1);
  number(
      o.speed_share, "speed_share", "", "",
      "model `single_track`: with objective lap_time, plans drive at most at this share of the speeds that "
      "a point mass with the usable grip drives along the path; the rest of the grip is for corrections",
      0.5, 1.5);
  number(o.braking_share, "braking_share", "", "",
         "model `single_track`: share of the usable grip that the mean deceleration of a step may use; below "
         "1 where the car's speed control brakes hardest right after a command",
         0.1, 1);
  number(o.grip_weight, "grip_weight", "", "",
         "model `single_track`: cost of the square of the share above usable_grip", 0, 1e6);
  number(o.friction_deviation, "friction_deviation", "", "",
         "model `single_track`: standard deviation of the logarithm of the friction in the variants of "
         "risk_variants",
         0, 1);
  number(o.cornering_deviation, "cornering_deviation", "", "",
         "model `single_track`: the same of the cornering stiffness", 0, 1);
  number(o.collision_ahead_cost, "collision_ahead_cost", "", "",
         "model `single_track`: cost of a plan that ends where the car cannot stop before an obstacle, times "
         "the share of its energy that is left there",
         0, 1e6);
}

}  // namespace slalom::vehicle
