#pragma once

#include <vector>

#include "slalom/sim/actuation.hpp"
#include "slalom/sim/car.hpp"
#include "slalom/sim/dynamics.hpp"

namespace slalom::sim {

/// What a driver asks of a car over one time step.
struct Command {
  double steering = 0;  ///< rad, or rad/s with SteeringInput::rate
  double drive = 0;     ///< m/s, or m/s^2 with SpeedInput::acceleration
};

enum class SteeringInput { angle, rate };
enum class SpeedInput { speed, acceleration };

/// What a car does in a step for which no usable command has come.
enum class Coast {
  roll,    ///< the wheels keep their angle, no drive and no brake
  brake,   ///< the wheels keep their angle, the car brakes to a stop
  repeat,  ///< the last command still holds (of a fresh car: stand still)
};

struct PlantOptions {
  DynamicsOptions dynamics;
  ActuationOptions actuation;
  SteeringInput steering_input = SteeringInput::angle;
  SpeedInput speed_input = SpeedInput::speed;
  double steering_dead_time =
      0.02;  ///< s, from a steering command to its effect; rounded to whole time steps
  Coast coast = Coast::roll;
  /// f1tenth_gym: the yaw is brought to [0, 2 pi] by at most one turn per step; elsewhere it lies in [-pi,
  /// pi].
  bool gym_yaw = false;
};

/// One car without a world round it: model, low-level control and steering dead time.
class Plant {
 public:
  /// `time_step` in seconds. Throws std::invalid_argument on parameters or options out of range.
  Plant(const CarParameters& car, const PlantOptions& options, double time_step);

  /// Puts the car somewhere; forgets commands under way.
  void reset(const CarState& state) noexcept;

  /// Moves by one time step. A command that is not finite is none.
  void step(const Command& command) noexcept;

  /// Moves by one time step without a command.
  void coast() noexcept;

  const CarState& state() const noexcept { return state_; }

  /// Changes the state, as a contact does; commands under way stay under way.
  void set_state(const CarState& state) noexcept { state_ = state; }

  /// The steering (as commanded) that took effect in the last step.
  double steering_applied() const noexcept { return applied_; }

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
