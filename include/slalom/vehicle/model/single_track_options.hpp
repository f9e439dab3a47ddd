#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// The sideways force of a tyre over its slip angle.
enum class TyreModel {
  linear,      ///< proportional to the slip angle, without bound
  saturating,  ///< Pacejka's curve: no more than friction times load, shared with drive and brakes
};
inline const char* const* enum_names(TyreModel) {
  static constexpr const char* const names[] = {"linear", "saturating", nullptr};
  return names;
}

/// The aim of a plan.
enum class Objective {
  path_speed,  ///< the speeds of the path, which plans do not exceed
  lap_time,    ///< the shortest time within grip and `max_speed`, whatever the speeds of the path
};
inline const char* const* enum_names(Objective) {
  static constexpr const char* const names[] = {"path_speed", "lap_time", nullptr};
  return names;
}

/// Options of `vehicle.model: single_track`. The defaults are the 1/10-scale car of f1tenth_gym.
/// `visit_options` below describes the fields.
struct SingleTrackOptions {
  Objective objective = Objective::path_speed;
  TyreModel tyres = TyreModel::saturating;
  double friction = 1.0489;
  double cornering_front = 4.718;
  double cornering_rear = 5.4562;
  double gravity_height = 0.074;
  double mass = 3.74;
  double inertia = 0.04712;  ///< The radius of gyration must be 0.1 to 1 wheelbase.
  double steer_rate = 3.2;
  double half_steer_speed = 5;
  double switch_speed = 7.319;
  double speed_gain = 4.755;
  double brake_gain = 19.02;
  double usable_grip = 0.9;
  double speed_share = 1;
  double braking_share = 1;
  double grip_weight = 300;
  double collision_ahead_cost = 100;

  bool operator==(const SingleTrackOptions&) const = default;
};

template <class Options, class Visit>
requires is_options_of<Options, SingleTrackOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.objective, {"objective", "",
                      "model `single_track`: plans seek the speeds of the path, or the shortest time within "
                      "grip and max_speed"});
  visit(o.tyres, {"tyres", "", "model `single_track`: sideways force over slip angle"});
  visit(o.friction,
        {"friction", "", "model `single_track`: friction coefficient between tyre and road", 0.05, 3, "mu"});
  visit(o.cornering_front,
        {"cornering_front", "1/rad",
         "model `single_track`: cornering stiffness of the front tyres over friction and load", 0.1, 100,
         "C_Sf"});
  visit(o.cornering_rear,
        {"cornering_rear", "1/rad",
         "model `single_track`: cornering stiffness of the rear tyres over friction and load", 0.1, 100,
         "C_Sr"});
  visit(o.gravity_height,
        {"gravity_height", "m", "model `single_track`: height of the centre of gravity", 0, 3, "h"});
  visit(o.mass, {"mass", "kg", "model `single_track`: mass of the car", 1e-3, 1e5, "m"});
  visit(o.inertia, {"inertia", "kg m^2", "model `single_track`: moment of inertia about the vertical axis",
                    1e-6, 1e6, "I_z"});
  visit(o.steer_rate,
        {"steer_rate", "rad/s", "model `single_track`: largest rate of the wheels' angle", 1e-2, 100});
  visit(o.half_steer_speed,
        {"half_steer_speed", "m/s",
         "model `single_track`: speed at which an input steers half as much as at a standstill", 0.1, 1000});
  visit(o.switch_speed,
        {"switch_speed", "m/s",
         "model `single_track`: speed above which the motor's power limits the acceleration", 0.1, 100});
  visit(o.speed_gain,
        {"speed_gain", "1/s",
         "model `single_track`: acceleration per error of speed of the car's speed control", 0.1, 1000});
  visit(o.brake_gain, {"brake_gain", "1/s",
                       "model `single_track`: acceleration per error of speed when braking", 0.1, 1000});
  visit(o.usable_grip,
        {"usable_grip", "", "model `single_track`: share of friction times gravity that a plan may use", 0.05,
         1});
  visit(o.speed_share, {"speed_share", "",
                        "model `single_track`: with objective lap_time, largest share of the speeds of a "
                        "point mass with the usable grip; the rest of the grip is for corrections",
                        0.5, 1.5});
  visit(o.braking_share, {"braking_share", "",
                          "model `single_track`: share of the usable grip for the mean deceleration of a "
                          "step; below 1 where the speed control brakes hardest right after a command",
                          0.1, 1});
  visit(o.grip_weight, {"grip_weight", "",
                        "model `single_track`: cost of the square of the share above usable_grip", 0, 1e6});
  visit(o.collision_ahead_cost, {"collision_ahead_cost", "",
                                 "model `single_track`: cost of a plan that ends where the car cannot stop "
                                 "before an obstacle, times the share of its energy that is left there",
                                 0, 1e6});
}

}  // namespace slalom::vehicle
