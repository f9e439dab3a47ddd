#pragma once

#include "slalom/core/options.hpp"
#include "slalom/sim/world.hpp"

/// The options of a world that Python has as keyword arguments. `WorldOptions::validate` checks them
/// together.
namespace slalom::sim {

inline const char* const* enum_names(CollisionResponse) {
  static constexpr const char* names[] = {"stop", "slide", "count_only", "slide_unless_struck", nullptr};
  return names;
}
inline const char* const* enum_names(Model) {
  static constexpr const char* names[] = {"kinematic", "single_track", "saturating", nullptr};
  return names;
}

template <class Options, class Visit>
requires is_options_of<Options, WorldOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.time_step, {"time_step", "s", "duration of a step"});
  visit(o.lidar.beams, {"beams", "", "number of beams of the LiDAR"});
  visit(o.lidar.field_of_view, {"field_of_view", "rad", "angle from the first beam to the last"});
  visit(o.lidar.range_max, {"range_max", "m", "longer ranges read range_max"});
  visit(o.lidar.noise, {"noise", "m", "standard deviation of each range"});
  visit(o.lidar.dropout, {"dropout", "", "fraction of beams without a return"});
  visit(o.lidar.rate, {"scan_rate", "Hz", "scans of the LiDAR per second; 0: one in every step"});
  visit(o.plant.dynamics.model, {"model", "", "equations of motion"});
  visit(o.car.friction, {"friction", "", "coefficient between tyre and road"});
  visit(o.car.cornering_front, {"cornering_front", "1/rad", "cornering stiffness over load, front axle"});
  visit(o.car.cornering_rear, {"cornering_rear", "1/rad", "cornering stiffness over load, rear axle"});
  visit(o.car.front_length, {"front_length", "m", "distance from the centre of gravity to the front axle"});
  visit(o.car.rear_length, {"rear_length", "m", "distance from the centre of gravity to the rear axle"});
  visit(o.car.gravity_height, {"gravity_height", "m", "height of the centre of gravity"});
  visit(o.car.mass, {"mass", "kg", "mass of a car"});
  visit(o.car.inertia, {"inertia", "kg m^2", "moment of inertia about the vertical axis"});
  visit(o.car.length, {"length", "m", "length of a car's body"});
  visit(o.car.width, {"width", "m", "width of a car's body"});
  visit(o.car.steer_max, {"steer_max", "rad", "largest steering angle to the left"});
  visit(o.car.steer_min, {"steer_min", "rad", "largest steering angle to the right, negative"});
  visit(o.car.steer_rate_max, {"steer_rate_max", "rad/s", "largest rate of the steering, either way"});
  visit(o.car.switch_speed,
        {"switch_speed", "m/s", "speed above which the motor's power limits the acceleration"});
  visit(o.car.speed_min, {"speed_min", "m/s", "highest speed in reverse, negative"});
  visit(o.car.acceleration_max, {"acceleration_max", "m/s^2", "largest acceleration of motor and brakes"});
  visit(o.car.speed_max, {"speed_max", "m/s", "highest speed of a car"});
  visit(o.wall_response, {"wall_response", "", "effect of a collision with a wall"});
  visit(o.body_response, {"body_response", "", "effect of a collision with a car, disc or box"});
}

}  // namespace slalom::sim
