#pragma once

#include <vector>

#include "slalom/core/options.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/vehicle/localisation/localiser_options.hpp"

/// What a lap on a real car has that one in a clean simulation does not: a LiDAR with noise and lost beams, a
/// pose that is guessed from it and from wheels that slip, and a servo that is not the one of the model.
namespace slalom::evaluation {

/// The scenario after the experiment on a car in Honda et al. (ICRA 2024), section VII, as far as it is
/// described: a Hokuyo UTM-30LX, localisation by a particle filter. The servo is slower to begin and quicker
/// to follow than the vehicle problem has it (0.025 s, 0.1 s), and out of trim.
struct HardwareConditions {
  double range_noise = 0.02;             ///< m, standard deviation of each range
  double dropout = 0.01;                 ///< share of beams without a return
  double steering_dead_time = 0.045;     ///< s
  double steering_time_constant = 0.07;  ///< s, of the servo's first-order lag
  double steering_gain = 0.95;           ///< of the wheels' angle over the commanded
  double steering_offset = 0.01;         ///< rad, to the left
  double speed_gain = 3.0;               ///< 1/s, acceleration per error of speed
  double acceleration_max = 6.0;         ///< m/s^2, and of braking
  double longest_blind = 0.1;            ///< s for which odometry alone carries the pose; then the car stops
  sim::WheelOdometryOptions wheels;
  vehicle::LocaliserOptions localiser;
};

template <class Options, class Visit>
requires is_options_of<Options, HardwareConditions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.range_noise, Declaration{"range_noise", "", "m", "of each range", 0, 1});
  visit(o.dropout, Declaration{"dropout", "", "", "share of beams without a return", 0, 1});
  visit(o.steering_dead_time, Declaration{"steering_dead_time", "", "s", "of the servo", 0, 1});
  visit(o.steering_time_constant,
        Declaration{"steering_time_constant", "", "s", "of the servo's lag", 0, 10});
  visit(o.steering_gain,
        Declaration{"steering_gain", "", "", "of the wheels' angle over the commanded", 0.1, 10});
  visit(o.steering_offset, Declaration{"steering_offset", "", "rad", "to the left", -0.4, 0.4});
  visit(o.speed_gain, Declaration{"speed_gain", "", "1/s", "acceleration per error of speed", 0.1, 100});
  visit(o.acceleration_max, Declaration{"acceleration_max", "", "m/s^2", "and of braking", 0.1, 100});
  visit(o.longest_blind,
        Declaration{"longest_blind", "", "s", "odometry alone carries the pose so long", 0, 10});
}

/// How well the car knew where it was in a lap.
struct LocalisationRecord {
  std::vector<float> error;      ///< m, of each pose that was driven by
  std::vector<float> yaw_error;  ///< rad
  std::vector<float> update_ms;  ///< wall clock of each update
  int blind = 0;                 ///< control steps without a pose to drive by
};

}  // namespace slalom::evaluation
