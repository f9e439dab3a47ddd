#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/random.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/sim/car.hpp"

namespace slalom::sim {

/// Errors of the odometry that the motor controller of a 1/10-scale car reports. It counts the turns of the
/// wheels and knows the commanded steering. With all errors 0 and `yaw_from_gyro`, the odometry is exact
/// dead reckoning. `visit_options` below describes the fields.
struct WheelOdometryOptions {
  std::uint64_t seed = 0;
  double speed_gain_error = 0.03;
  double slip_per_acceleration = 0.01;
  double speed_noise = 0.03;
  bool yaw_from_gyro = false;
  double steer_gain_error = 0.02;
  double steer_offset = 0.005;
  double gyro_bias = 0.005;
  double gyro_noise = 0.02;
};

template <class Options, class Visit>
requires is_options_of<Options, WheelOdometryOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.seed, {"seed", "", "seed of the noise"});
  visit(o.speed_gain_error,
        {"speed_gain_error", "", "share by which the assumed wheel is larger than the real one", -0.9, 0.9});
  visit(o.slip_per_acceleration, {"slip_per_acceleration", "s^2/m",
                                  "share by which wheels turn faster per m/s^2 of drive", -0.5, 0.5});
  visit(o.speed_noise, {"speed_noise", "m/s", "standard deviation of each reading of the speed", 0, 10});
  visit(o.yaw_from_gyro, {"yaw_from_gyro", "",
                          "the yaw is that of a gyro; otherwise of the steering, by the kinematic bicycle"});
  visit(o.steer_gain_error, {"steer_gain_error", "",
                             "share by which the assumed steering is larger than the real one", -0.9, 0.9});
  visit(o.steer_offset, {"steer_offset", "rad",
                         "angle by which the assumed steering is to the left of the real one", -0.5, 0.5});
  visit(o.gyro_bias, {"gyro_bias", "rad/s", "bias of the yaw rate", -10, 10});
  visit(o.gyro_noise, {"gyro_noise", "rad/s", "standard deviation of each reading of the yaw rate", 0, 10});
}

/// Dead reckoning of the rear axle from wheels and steering (or a gyro), with slip and bias, in a frame that
/// begins where the car begins.
class WheelOdometry {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit WheelOdometry(const CarParameters& car = {}, const WheelOdometryOptions& options = {});

  void reset(const CarState& state) noexcept;  ///< starts again at the origin

  /// Moves the odometry. Call it after each step of `time_step` (s) with the state reached. A time step that
  /// is not above 0 and a state that is not finite change nothing.
  void update(const CarState& state, double time_step) noexcept;

  const maps::Pose& pose() const noexcept { return pose_; }  ///< pose of the rear axle, odometry frame
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
