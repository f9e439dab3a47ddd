#pragma once

#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/course/speed_profile.hpp"

namespace slalom::vehicle {

/// The properties of a car on which its raceline depends. Lateral and longitudinal acceleration are inside an
/// ellipse with these limits as half axes.
struct RacingCar {
  std::string name = "f1tenth";                ///< name of the car, for messages
  double width = 0.31;                         ///< m, of the body
  double margin = 0.15;                        ///< m, that the body keeps from walls in wide places
  double wheelbase = 0.3302;                   ///< m
  double max_steering = 0.4;                   ///< rad, of the front wheels
  double max_steering_rate = 3.2;              ///< rad/s
  SpeedLimits limits{8, 8.829, 8.829, 8.829};  ///< top speed and accelerations
  double power = std::numeric_limits<double>::infinity();  ///< W/kg: v dv/dt is at most this
};

/// Throws std::invalid_argument that names the key, its value and the rule.
void validate(const RacingCar& car);

/// The names of the cars that racing_car() knows.
std::vector<std::string> racing_car_names();

/// A car by its name: `f1tenth` (scale 1/10, no power limit, top speed 8 m/s, friction coefficient 0.9) or
/// `passenger` (a full-scale car on a dry road). Throws std::invalid_argument that lists the names.
RacingCar racing_car(const std::string& name);

/// The car of a configuration, with the grip that its plans may use (friction times usable_grip), three times
/// their margin, and the top speed of racing_car(), by the wheelbase; planner.max_speed is for driving.
RacingCar racing_car(const Configuration& configuration);

/// Sets the accelerations to those of a friction coefficient, `friction` g in every direction. Throws
/// std::invalid_argument unless `friction` is finite and above 0.
void set_friction(RacingCar& car, double friction);

/// The share of its margin that a car keeps in the narrowest places.
inline constexpr double least_margin_share = 0.4;
/// m that the centre of the car keeps from the walls of a corridor of this width (m): half the width of the
/// car and its margin. Where the corridor is narrow, the margin is a quarter of the room beside the car, but
/// at least `least_margin_share` of it.
inline double wall_distance(const RacingCar& car, double corridor_width) {
  return 0.5 * car.width +
         std::clamp(0.25 * (corridor_width - car.width), least_margin_share * car.margin, car.margin);
}
/// The same in the narrowest place that the car can pass.
inline double least_wall_distance(const RacingCar& car) {
  return wall_distance(car, 0);
}

/// 1/m, the tightest curvature that the steering reaches: tan(max_steering) / wheelbase.
double max_curvature(const RacingCar& car);

/// The highest speeds (m/s) of a car along a path: as feasible_speeds(), with limits that hold at both ends
/// and in the middle of a piece, and with steering no faster than the car's. `curvature` and `step` are as
/// there. Throws std::invalid_argument for an invalid car and sizes that differ.
std::vector<double> racing_speeds(std::span<const double> curvature, std::span<const double> step,
                                  bool closed, const RacingCar& car);

}  // namespace slalom::vehicle
