#pragma once

#include "slalom/maps/command.hpp"
#include "slalom/sim/car.hpp"
#include "slalom/sim/dynamics.hpp"

namespace slalom::sim {

/// The control between a command and the model's input. `visit_options` of PlantOptions describes the gains.
struct ActuationOptions {
  double speed_gain = 4.755;
  double brake_gain = 19.02;
  /// As f1tenth_gym: the steering moves at full rate or not at all, and the limits of speed give the gains.
  bool gym = false;
};

/// The steering rate (rad/s) that turns the wheels from `steer` to `target` (rad): the actuator gets there
/// within `time_step` (s) where its rate allows.
double steer_rate_towards(const CarParameters& car, const ActuationOptions& options, double steer,
                          double target, double time_step) noexcept;

/// The acceleration (m/s^2) that takes the car from `speed` to `target` (m/s), by their difference.
double acceleration_towards(const CarParameters& car, const ActuationOptions& options, double speed,
                            double target) noexcept;

/// Options of a car with its actuators. `visit_options` below describes the fields.
struct PlantOptions {
  DynamicsOptions dynamics{};        ///< car dynamics
  ActuationOptions actuation{};      ///< conversion of commands to steering and acceleration
  double steering_dead_time = 0.02;  ///< rounded to whole time steps
  bool gym = false;  ///< as f1tenth_gym: the yaw is brought to [0, 2 pi] by at most one turn per step
};

template <class Options, class Visit>
requires is_options_of<Options, PlantOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.dynamics.model, {"model", "", "equations of motion"});
  visit(o.dynamics.integrator, {"integrator", "", "integration of the equations of motion"});
  visit(o.dynamics.substeps, {"substeps", "", "parts of a step; 0: as many as keep tyres stable", 0, 1000});
  visit(o.steering_dead_time,
        {"steering_dead_time", "s", "time until a steering command takes effect", 0, 1});
  visit(o.actuation.speed_gain, {"speed_gain", "1/s", "acceleration per error of speed", 1e-9, 1e9});
  visit(o.actuation.brake_gain,
        {"brake_gain", "1/s", "acceleration per error of speed when braking", 1e-9, 1e9});
}

/// One car without a world round it: model, low-level control and steering dead time.
class Plant {
 public:
  /// `time_step` in seconds. Throws std::invalid_argument on parameters or options out of range.
  Plant(const CarParameters& car, const PlantOptions& options, double time_step);

  void reset(const CarState& state) noexcept;  ///< puts the car somewhere; forgets commands under way

  /// Moves by one time step. With a command that is not finite it coasts.
  void step(const Command& command) noexcept;

  /// Moves by one time step without a command: the wheels keep their angle, no drive and no brake.
  void coast() noexcept;

  const CarState& state() const noexcept { return state_; }  ///< current state

  /// Changes the state, as a collision does; commands under way stay under way.
  void set_state(const CarState& state) noexcept { state_ = state; }

  /// The steering (as commanded) that took effect in the last step.
  double steering_applied() const noexcept { return applied_; }

  const CarParameters& car() const noexcept { return car_; }  ///< parameters of the car

 private:
  double delayed(double steering) noexcept;
  void move(const DriveInput& input) noexcept;

  CarParameters car_;
  PlantOptions options_;
  double time_step_;
  CarState state_;
  double applied_ = 0;
  std::vector<double> on_the_way_;  ///< ring of steering commands, the oldest at next_
  std::size_t next_ = 0;
};

}  // namespace slalom::sim
