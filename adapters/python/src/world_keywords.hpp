#pragma once

#include "slalom/core/options.hpp"
#include "slalom/sim/world.hpp"

/// The options of a world by name, for keyword arguments. `WorldOptions::validate` checks them together.
namespace slalom::sim {

inline const char* const* enum_names(CollisionResponse) {
  static constexpr const char* names[] = {"stop", "slide", "count_only", "slide_unless_struck", nullptr};
  return names;
}
inline const char* const* enum_names(Model) {
  static constexpr const char* names[] = {"kinematic", "single_track", "saturating", nullptr};
  return names;
}
inline const char* const* enum_names(Integrator) {
  static constexpr const char* names[] = {"runge_kutta_4", "euler", nullptr};
  return names;
}
inline const char* const* enum_names(Coast) {
  static constexpr const char* names[] = {"roll", "brake", "repeat", nullptr};
  return names;
}
inline const char* const* enum_names(SteeringInput) {
  static constexpr const char* names[] = {"angle", "rate", nullptr};
  return names;
}
inline const char* const* enum_names(SpeedInput) {
  static constexpr const char* names[] = {"speed", "acceleration", nullptr};
  return names;
}

template <class Options, class Visit>
requires is_options_of<Options, WorldOptions>
void visit_options(Options& o, Visit&& visit) {
  const auto option = [&](auto& field, const char* name, const char* unit, const char* help) {
    visit(field, Declaration{.name = name, .unit = unit, .help = help});
  };
  option(o.time_step, "time_step", "s", "duration of a step");
  option(o.lidar.beams, "beams", "", "of the LiDAR");
  option(o.lidar.field_of_view, "field_of_view", "rad", "from the first beam to the last");
  option(o.lidar.range_max, "range_max", "m", "what is farther reads range_max");
  option(o.lidar.noise, "noise", "m", "standard deviation of each range");
  option(o.lidar.dropout, "dropout", "", "fraction of beams without a return");
  option(o.lidar.rate, "scan_rate", "Hz", "of the LiDAR; 0 scans in every step");
  option(o.plant.dynamics.model, "model", "", "equations of motion");
  option(o.plant.steering_dead_time, "steering_dead_time", "s", "from a steering command to its effect");
  option(o.plant.steering_input, "steering_input", "", "what the steering command is");
  option(o.plant.speed_input, "speed_input", "", "what the speed command is");
  option(o.plant.dynamics.integrator, "integrator", "", "of the equations of motion");
  option(o.plant.dynamics.substeps, "substeps", "", "of a step; 0: as many as keep the tyres stable");
  option(o.plant.actuation.speed_gain, "speed_gain", "1/s", "acceleration per error of speed");
  option(o.plant.actuation.brake_gain, "brake_gain", "1/s", "the same when braking");
  option(o.plant.coast, "coast", "", "what a car does without a usable command");
  option(o.car.friction, "friction", "", "coefficient between tyre and road");
  option(o.car.cornering_front, "cornering_front", "1/rad", "cornering stiffness over load, front axle");
  option(o.car.cornering_rear, "cornering_rear", "1/rad", "the same of the rear axle");
  option(o.car.front_length, "front_length", "m", "from the centre of gravity to the front axle");
  option(o.car.rear_length, "rear_length", "m", "from the centre of gravity to the rear axle");
  option(o.car.gravity_height, "gravity_height", "m", "of the centre of gravity");
  option(o.car.mass, "mass", "kg", "of a car");
  option(o.car.inertia, "inertia", "kg m^2", "moment about the vertical axis");
  option(o.car.length, "length", "m", "of a car's body");
  option(o.car.width, "width", "m", "of a car's body");
  option(o.car.steer_max, "steer_max", "rad", "largest steering angle to the left");
  option(o.car.steer_min, "steer_min", "rad", "largest steering angle to the right, negative");
  option(o.car.steer_rate_max, "steer_rate_max", "rad/s", "of the steering, either way");
  option(o.car.switch_speed, "switch_speed", "m/s", "above it the motor's power limits the acceleration");
  option(o.car.speed_min, "speed_min", "m/s", "of a car in reverse, negative");
  option(o.car.acceleration_max, "acceleration_max", "m/s^2", "of motor and brakes");
  option(o.car.speed_max, "speed_max", "m/s", "highest speed of a car");
  option(o.sectors, "sectors", "", "parts of a lap with a split time");
  option(o.wall_response, "wall_response", "", "what a collision with a wall does");
  option(o.body_response, "body_response", "", "what a collision with a car, disc or box does");
}

}  // namespace slalom::sim
