#pragma once

#include "slalom/core/options.hpp"
#include "slalom/core/random.hpp"
#include "slalom/maps/imu_reading.hpp"
#include "slalom/sim/car.hpp"

namespace slalom::sim {

/// Errors of an inertial measurement unit. The biases are constant for a drive and drawn at its start.
/// `visit_options` below describes the fields.
struct ImuOptions {
  std::uint64_t seed = 0;
  double gyro_bias = 0.01;
  double gyro_noise = 0.02;
  double accelerometer_bias = 0.1;
  double accelerometer_noise = 0.5;
};

template <class Options, class Visit>
requires is_options_of<Options, ImuOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.seed, {"seed", "", "seed of the errors"});
  visit(o.gyro_bias, {"gyro_bias", "rad/s", "standard deviation over drives of the yaw rate's bias", 0, 10});
  visit(o.gyro_noise, {"gyro_noise", "rad/s", "standard deviation of a sample of the yaw rate", 0, 10});
  visit(o.accelerometer_bias,
        {"accelerometer_bias", "m/s^2", "standard deviation over drives of the bias of each axis", 0, 10});
  visit(o.accelerometer_noise,
        {"accelerometer_noise", "m/s^2",
         "standard deviation of a sample of each axis, with the car's vibration", 0, 10});
}

/// An inertial measurement unit at the car's centre of gravity. It takes a sample in each step.
class Imu {
 public:
  /// Throws std::invalid_argument on options out of range.
  explicit Imu(const ImuOptions& options = {});

  /// Begins a drive with the car in this state; draws the biases.
  void reset(const CarState& state) noexcept;

  /// Takes a sample. Call it after each step of `time_step` (s) with the state reached. A time step that is
  /// not above 0 and a state that is not finite change nothing.
  void update(const CarState& state, double time_step) noexcept;

  /// The mean of the samples since the last call, or the last reading where there is none.
  ImuReading read() noexcept;

 private:
  ImuOptions options_;
  RandomStream random_;
  ImuReading bias_, sum_, last_;
  CarState before_;
  int samples_ = 0;
};

}  // namespace slalom::sim
