#pragma once

#include "slalom/core/options.hpp"

namespace slalom::vehicle {

/// The probability of a range at a pose (Thrun, Burgard & Fox, "Probabilistic Robotics", 2005, Ch. 6).
enum class SensorModel {
  likelihood_field,  ///< distance from the beam's end to the nearest wall (Table 6.3)
  beam,              ///< range expected from the map, by a table that is computed at construction (Table 6.1)
};
inline const char* const* enum_names(SensorModel) {
  static constexpr const char* names[] = {"likelihood_field", "beam", nullptr};
  return names;
}

/// Options of Localiser: those of the car and its sensors. `visit_options` below describes the fields.
struct LocaliserOptions {
  std::uint64_t seed = 0;
  SensorModel sensor_model = SensorModel::beam;

  double laser_x = 0.275;
  double laser_y = 0;
  double laser_yaw = 0;

  int beams = 60;
  int min_beams = 12;
  double range_cap = 12;
  double hit_deviation = 0.08;

  double along_noise = 0.15;
  double across_noise = 0.05;
  double turn_noise = 0.1;
  double drift_noise = 0.04;
  double position_noise = 0.006;
  double yaw_noise = 0.004;
  double max_speed = 12;

  int min_particles = 500;
  int max_particles = 4000;

  /// Throws std::invalid_argument naming the field, its value and the rule.
  void validate() const;
};

template <class Options, class Visit>
requires is_options_of<Options, LocaliserOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.seed, {"seed", "", "seed of the random numbers"});
  visit(o.sensor_model,
        {"sensor_model", "",
         "probability of a range at a pose; beam needs a table, and is likelihood_field on maps too "
         "large for one"});
  visit(o.laser_x, {"laser_x", "m", "position of the laser ahead of the rear axle", -10, 10});
  visit(o.laser_y, {"laser_y", "m", "position of the laser to the left of the rear axle", -10, 10});
  visit(o.laser_yaw, {"laser_yaw", "rad", "direction of the laser", -3.2, 3.2});
  visit(o.beams, {"beams", "", "number of beams used per scan, evenly spaced", 8, 1024});
  visit(o.min_beams, {"min_beams", "", "a scan with fewer usable readings is not used", 1, 1024});
  visit(o.range_cap, {"range_cap", "m", "longer readings are not used", 0.5, 1000});
  visit(o.hit_deviation, {"hit_deviation", "m", "standard deviation of range, map and deskewing together",
                          1e-3, 10, "sigma_hit"});
  visit(o.along_noise, {"along_noise", "", "standard deviation along the car, m per m driven", 0, 10});
  visit(o.across_noise, {"across_noise", "", "standard deviation across the car, m per m driven", 0, 10});
  visit(o.turn_noise, {"turn_noise", "", "standard deviation of the yaw, rad per rad turned", 0, 10});
  visit(o.drift_noise, {"drift_noise", "rad/m", "standard deviation of the yaw per m driven", 0, 10});
  visit(o.position_noise,
        {"position_noise", "m", "standard deviation of the position in each update, in addition", 1e-6, 1});
  visit(o.yaw_noise,
        {"yaw_noise", "rad", "standard deviation of the yaw in each update, in addition", 1e-6, 1});
  visit(o.max_speed, {"max_speed", "m/s", "faster odometry is a jump", 0.1, 100});
  visit(o.min_particles, {"min_particles", "", "smallest number of particles", 64, 1e6});
  visit(o.max_particles,
        {"max_particles", "", "largest number of particles, at least min_particles", 64, 1e6});
}

}  // namespace slalom::vehicle
