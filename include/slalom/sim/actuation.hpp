#pragma once

#include "slalom/sim/car.hpp"
#include "slalom/sim/gym.hpp"

namespace slalom::sim {

/// The low-level control between a command and the model's input.
struct ActuationOptions {
  double speed_gain = 4.755;  ///< 1/s, acceleration per error of speed; braking takes brake_gain
  double brake_gain = 19.02;  ///< 1/s, the same when braking
  GymActuation gym{};         ///< reproduction of f1tenth_gym

  /// Throws std::invalid_argument naming the field, its value and the rule it breaks.
  void validate() const;
};

/// The steering rate (rad/s) that turns the wheels from `steer` to `target` (rad): the actuator gets there
/// within `time_step` (s) where its rate allows.
double steer_rate_towards(const CarParameters& car, const ActuationOptions& options, double steer,
                          double target, double time_step) noexcept;

/// The acceleration (m/s^2) that takes the car from `speed` to `target` (m/s): proportional to the
/// difference.
double acceleration_towards(const CarParameters& car, const ActuationOptions& options, double speed,
                            double target) noexcept;

}  // namespace slalom::sim
