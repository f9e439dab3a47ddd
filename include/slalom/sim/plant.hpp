#pragma once

#include <vector>

#include "slalom/maps/command.hpp"
#include "slalom/sim/actuation.hpp"
#include "slalom/sim/car.hpp"
#include "slalom/sim/dynamics.hpp"

namespace slalom::sim {

/// The meaning of `Command::steer`: an angle, rad, or the rate of the angle, rad/s.
enum class SteeringInput { angle, rate };
/// The meaning of `Command::speed`: a speed, m/s, or an acceleration, m/s^2.
enum class SpeedInput { speed, acceleration };

/// The behaviour of a car in a step without a usable command.
enum class Coast {
  roll,    ///< the wheels keep their angle, no drive and no brake
  brake,   ///< the wheels keep their angle, the car brakes to a stop
  repeat,  ///< the last command still holds (of a fresh car: stand still)
};

/// Options of a car with its actuators.
struct PlantOptions {
  DynamicsOptions dynamics;    ///< car dynamics
  ActuationOptions actuation;  ///< conversion of commands to steering and acceleration
  SteeringInput steering_input = SteeringInput::angle;  ///< meaning of the steering command
  SpeedInput speed_input = SpeedInput::speed;           ///< meaning of the speed command
  double steering_dead_time =
      0.02;                   ///< s, from a steering command to its effect; rounded to whole time steps
  Coast coast = Coast::roll;  ///< behaviour without a command
  GymPlant gym{};             ///< reproduction of f1tenth_gym
};

/// One car without a world round it: model, low-level control and steering dead time.
class Plant {
 public:
  /// `time_step` in seconds. Throws std::invalid_argument on parameters or options out of range.
  Plant(const CarParameters& car, const PlantOptions& options, double time_step);

  /// Puts the car somewhere; forgets commands under way.
  void reset(const CarState& state) noexcept;

  /// Moves by one time step. With a command that is not finite it coasts.
  void step(const Command& command) noexcept;

  /// Moves by one time step without a command.
  void coast() noexcept;

  /// Current state.
  const CarState& state() const noexcept { return state_; }

  /// Changes the state, as a collision does; commands under way stay under way.
  void set_state(const CarState& state) noexcept { state_ = state; }

  /// The steering (as commanded) that took effect in the last step.
  double steering_applied() const noexcept { return applied_; }

  /// Parameters of the car.
  const CarParameters& car() const noexcept { return car_; }

 private:
  double delayed(double steering) noexcept;
  void move(const DriveInput& input) noexcept;

  CarParameters car_;
  PlantOptions options_;
  double time_step_;
  CarState state_;
  Command last_;
  double applied_ = 0;
  std::vector<double> on_the_way_;  ///< ring of steering commands, the oldest at next_
  std::size_t next_ = 0;
};

}  // namespace slalom::sim
