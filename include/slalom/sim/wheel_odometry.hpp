#pragma once

#include <cstdint>

#include "slalom/core/options.hpp"
#include "slalom/core/random.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/sim/car.hpp"

namespace slalom::sim {

/// Errors of the odometry that the motor controller of a 1/10-scale car reports. It counts the turns of the
/// wheels and knows the commanded steering. With all errors 0 and `yaw_from_gyro`, the odometry is exact
/// dead reckoning.
struct WheelOdometryOptions {
  std::uint64_t seed = 0;               ///< seed of the random numbers
  double speed_gain_error = 0.03;       ///< share by which the assumed wheel is larger than the real one
  double slip_per_acceleration = 0.01;  ///< s^2/m: wheels turn faster by this share per m/s^2 of drive
  double speed_noise = 0.03;            ///< m/s, standard deviation of each reading
  bool yaw_from_gyro = false;      ///< else from the steering by the kinematic bicycle, which has no slip
  double steer_gain_error = 0.02;  ///< share by which the assumed steering is larger than the real one
  double steer_offset = 0.005;     ///< rad, by which the assumed steering is to the left of the real one
  double gyro_bias = 0.005;        ///< rad/s
  double gyro_noise = 0.02;        ///< rad/s, standard deviation of each reading

  /// Throws std::invalid_argument naming the field, its value and the rule.
  void validate() const;
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, WheelOdometryOptions>
void visit_options(Options& o, Visit&& visit) {
  const auto number = [&](auto& field, const char* name, const char* unit, const char* help, double bound) {
    visit(field, Declaration{.name = name, .unit = unit, .help = help, .min = -bound, .max = bound});
  };
  visit(o.seed, Declaration{.name = "seed", .help = "of the noise"});
  number(o.speed_gain_error, "speed_gain_error", "", "share by which the assumed wheel is larger", 0.9);
  number(o.slip_per_acceleration, "slip_per_acceleration", "s^2/m", "wheels turn faster under drive", 0.5);
  visit(o.speed_noise,
        Declaration{.name = "speed_noise", .unit = "m/s", .help = "of each reading", .min = 0, .max = 10});
  visit(o.yaw_from_gyro, Declaration{.name = "yaw_from_gyro", .help = "else from the steering"});
  number(o.steer_gain_error, "steer_gain_error", "", "share by which the assumed steering is larger", 0.9);
  number(o.steer_offset, "steer_offset", "rad", "by which the assumed steering is to the left", 0.5);
  number(o.gyro_bias, "gyro_bias", "rad/s", "of the yaw rate", 10);
  visit(o.gyro_noise,
        Declaration{.name = "gyro_noise", .unit = "rad/s", .help = "of each reading", .min = 0, .max = 10});
}

/// Dead reckoning of the rear axle from wheels and steering (or a gyro), with slip and bias, in a frame that
/// begins where the car begins.
class WheelOdometry {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit WheelOdometry(const CarParameters& car = {}, const WheelOdometryOptions& options = {});

  /// Starts again; the first pose of the odometry is `start`.
  void reset(const CarState& state, const maps::Pose& start = {}) noexcept;

  /// To be called after each step of `time_step` (s) with the state reached. A time step that is not above 0
  /// and a state that is not finite change nothing.
  void update(const CarState& state, double time_step) noexcept;

  const maps::Pose& pose() const noexcept { return pose_; }  ///< of the rear axle, odometry frame
  double speed() const noexcept { return speed_; }           ///< m/s, as the wheels have it
  double yaw_rate() const noexcept { return yaw_rate_; }     ///< rad/s

 private:
  CarParameters car_;
  WheelOdometryOptions options_;
  RandomStream random_;
  maps::Pose pose_;
  double speed_ = 0;
  double yaw_rate_ = 0;
  double true_speed_ = 0;  ///< m/s, before the last step
};

/// The pose of the rear axle of a car in a state.
maps::Pose rear_axle(const CarParameters& car, const CarState& state) noexcept;

}  // namespace slalom::sim
