#pragma once

#include "slalom/core/options.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::sim {

/// The parameters of a car, by default the 1/10-scale car of f1tenth_gym. `visit_options` describes them.
struct CarParameters {
  double friction = 1.0489;
  double cornering_front = 4.718;
  double cornering_rear = 5.4562;
  double front_length = 0.15875;
  double rear_length = 0.17145;
  double gravity_height = 0.074;
  double mass = 3.74;
  double inertia = 0.04712;
  double steer_min = -0.4189;
  double steer_max = 0.4189;
  double steer_rate_max = 3.2;
  double switch_speed = 7.319;
  double acceleration_max = 9.51;
  double speed_min = -5.0;
  double speed_max = 20.0;
  double length = 0.58;
  double width = 0.31;

  double wheelbase() const { return front_length + rear_length; }  ///< distance between the axles, m

  /// A passenger car: parameter set 2 (a BMW 320i) of Althoff & Wuersching, "CommonRoad: Vehicle Models"
  /// (2020), as its single-track model uses them.
  static CarParameters full_scale();
};

template <class Options, class Visit>
requires is_options_of<Options, CarParameters>
void visit_options(Options& o, Visit&& visit) {
  constexpr double least = 1e-9, most = 1e9;  // limits of the values that must be above 0
  visit(o.friction, {"friction", "", "coefficient between tyre and road", least, most, "mu"});
  visit(o.cornering_front,
        {"cornering_front", "1/rad", "cornering stiffness over load, front axle", least, most, "C_Sf"});
  visit(o.cornering_rear,
        {"cornering_rear", "1/rad", "cornering stiffness over load, rear axle", least, most, "C_Sr"});
  visit(o.front_length, {"front_length", "m", "centre of gravity to the front axle", least, most, "l_f"});
  visit(o.rear_length, {"rear_length", "m", "centre of gravity to the rear axle", least, most, "l_r"});
  visit(o.gravity_height, {"gravity_height", "m", "height of the centre of gravity", 0, 10, "h"});
  visit(o.mass, {"mass", "kg", "mass of a car", least, most, "m"});
  visit(o.inertia, {"inertia", "kg m^2", "moment of inertia about the vertical axis", least, most, "I_z"});
  visit(o.steer_min, {"steer_min", "rad", "largest steering angle to the right, negative", -1.5, 0});
  visit(o.steer_max, {"steer_max", "rad", "largest steering angle to the left", 0, 1.5});
  visit(o.steer_rate_max, {"steer_rate_max", "rad/s", "largest rate of steering, either way", least, most});
  visit(o.switch_speed, {"switch_speed", "m/s", "speed above which power limits acceleration", least, most});
  visit(o.acceleration_max,
        {"acceleration_max", "m/s^2", "largest acceleration of motor and brakes", least, most});
  visit(o.speed_min, {"speed_min", "m/s", "highest speed in reverse, negative", -1000, 0});
  visit(o.speed_max, {"speed_max", "m/s", "highest speed of a car", least, most});
  visit(o.length, {"length", "m", "length of a car; its middle is the centre of gravity", least, most});
  visit(o.width, {"width", "m", "width of a car's body", least, most});
}

/// The state of a car; its position is that of the centre of gravity.
struct CarState {
  double x = 0;         ///< m
  double y = 0;         ///< m
  double steer = 0;     ///< delta, rad, angle of the front wheels, to the left positive
  double speed = 0;     ///< v, m/s, along the direction of travel; negative in reverse
  double yaw = 0;       ///< psi, rad
  double yaw_rate = 0;  ///< rad/s
  double slip = 0;      ///< beta, rad, from the body's axis to the direction of travel

  bool operator==(const CarState&) const = default;
  maps::Pose pose() const { return {x, y, yaw}; }  ///< pose of the centre of gravity
  /// Whether all values are finite.
  bool is_finite() const {
    for (const double value : {x, y, steer, speed, yaw, yaw_rate, slip})
      if (!std::isfinite(value)) return false;
    return true;
  }
};

/// The inputs of the model; both are held over a time step.
struct DriveInput {
  double steer_rate = 0;    ///< rad/s
  double acceleration = 0;  ///< m/s^2
};

}  // namespace slalom::sim
