#pragma once

#include "slalom/core/options.hpp"
#include "slalom/sim/imu.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/vehicle/localisation/localiser_options.hpp"

/// The conditions of a real car, in contrast to an ideal simulation: a LiDAR with noise and missing returns,
/// a pose estimated from the LiDAR and the odometry of slipping wheels, and a servo unlike the model.
namespace slalom::evaluation {

/// Conditions after the experiment on a car in Honda et al. (ICRA 2024), section V-C, as far as it is
/// described: a Hokuyo UTM-30LX, localisation by a particle filter. Compared with the vehicle problem (0.025
/// s, 0.1 s) the servo has a longer dead time, a shorter time constant, a wrong gain and an offset.
/// `visit_options` below describes the fields.
struct HardwareConditions {
  double range_noise = 0.02;
  double dropout = 0.01;
  double steering_dead_time = 0.045;
  double steering_time_constant = 0.07;
  double steering_gain = 0.95;
  double steering_offset = 0.01;
  double speed_gain = 3.0;
  double acceleration_max = 6.0;
  double max_blind_time = 0.1;
  bool imu = true;
  sim::WheelOdometryOptions wheels{};  ///< errors of the wheel odometry; its seed is that of the lap
  sim::ImuOptions inertial{};  ///< errors of the inertial measurement unit; its seed is that of the lap
  vehicle::LocaliserOptions localiser{};  ///< its seed is that of the lap

  /// The sensors and the localisation of a real car, whose LiDAR has this noise (m, standard deviation) and
  /// dropout (fraction of beams without a return): pose and speed are estimates, the planner gets the IMU,
  /// and the odometry takes its yaw from the gyro. Servo and motor are those of the simulated car.
  static HardwareConditions sensors(double range_noise, double dropout);
};

/// Declares the options above; those of `wheels`, `inertial` and `localiser` are declared with their structs.
template <class Options, class Visit>
requires is_options_of<Options, HardwareConditions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.range_noise, {"range_noise", "m", "standard deviation of each range", 0, 1});
  visit(o.dropout, {"dropout", "", "fraction of beams without a return", 0, 1});
  visit(o.steering_dead_time, {"steering_dead_time", "s", "dead time of the servo", 0, 1});
  visit(o.steering_time_constant,
        {"steering_time_constant", "s", "time constant of the servo's first-order lag", 0, 10});
  visit(o.steering_gain, {"steering_gain", "", "angle of the wheels / commanded angle", 0.1, 10});
  visit(o.steering_offset,
        {"steering_offset", "rad", "added to the angle of the wheels, positive to the left", -0.4, 0.4});
  visit(o.speed_gain, {"speed_gain", "1/s", "acceleration / speed error", 0.1, 100});
  visit(o.acceleration_max, {"acceleration_max", "m/s^2", "largest acceleration, also of braking", 0.1, 100});
  visit(o.max_blind_time,
        {"max_blind_time", "s", "time without localisation, on odometry alone, before the car stops", 0, 10});
  visit(o.imu, {"imu", "", "the planner gets the readings of an inertial measurement unit"});
}

/// Errors of the localisation in a lap.
struct LocalisationRecord {
  std::vector<float> error;      ///< m, of each pose that the planner got
  std::vector<float> yaw_error;  ///< rad, absolute
  std::vector<float> update_ms;  ///< wall-clock time of each update of the localiser
  int blind = 0;                 ///< control steps in which the planner got no pose
};

}  // namespace slalom::evaluation
