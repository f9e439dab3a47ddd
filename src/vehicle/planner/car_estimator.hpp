#pragma once

#include <algorithm>
#include <cmath>

#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/estimation/parameter_estimator.hpp"
#include "vehicle/estimation/state_observer.hpp"

namespace slalom::vehicle::detail {

/// Estimates state and parameters of a car whose tyres slip. States and plans hold the angle of the wheels. A
/// command is this angle less the car's steering offset, divided by its steering gain.
class CarEstimator {
 public:
  CarEstimator(const PlannerOptions& options, const DynamicVehicleModel& model)
      : identify_(options.estimation.identify),
        latency_(options.latency),
        steer_resolution_(options.steer_resolution),
        friction_(model.traits().tyres.friction),
        observer_(options.estimation, options.control_period, options.latency, model.traits().dead_time),
        parameters_(model.dynamics(), options.estimation, model.traits().tyres.friction,
                    options.latency + model.traits().dead_time, options.control_period) {}

  void reset() noexcept {
    observer_.reset();
    parameters_.reset();
  }

  /// Takes the measurements one control period after the last ones. Predictions use the mean friction.
  void update(const DynamicVehicleModel& model, const ObserverInput& input) noexcept {
    ObserverInput checked = input;
    if (input.imu && !plausible(*input.imu)) checked.imu.reset();
    observer_.update(model, checked, parameters().friction);
    if (!identify_) return;
    const VehicleStart& car = observer_.now();
    parameters_.update({input.pose, car.speed, car.yaw_rate, car.slip});
    observer_.set_dead_time(std::max(0.0, parameters_.estimate().delay - latency_));
  }

  /// Returns the command for this angle of the wheels, rounded to the resolution of the steering.
  Command command(const Command& wheels, double steer_limit) const noexcept {
    Command command = wheels;
    const ParameterEstimate car = parameters();
    command.steer =
        std::clamp((wheels.steer - car.steering_offset) / car.steering_gain, -steer_limit, steer_limit);
    if (const double step = steer_resolution_; step > 0) {
      const double most = std::floor(steer_limit / step);
      command.steer = step * std::clamp(std::round(command.steer / step), -most, most);
    }
    return command;
  }

  /// Records the command that the car obeys from now on.
  void send(const Command& command) noexcept {
    const ParameterEstimate car = parameters();
    observer_.send({command.steer * car.steering_gain + car.steering_offset, command.speed});
    parameters_.send(command.steer);
  }

  /// Returns the estimate of car and ground, or the given values if nothing is learned.
  ParameterEstimate parameters() const noexcept {
    if (identify_) return parameters_.estimate();
    return {.friction = friction_, .cautious_friction = friction_};
  }
  const StateObserver& state() const noexcept { return observer_; }

 private:
  bool identify_;
  double latency_, steer_resolution_, friction_;
  StateObserver observer_;
  ParameterEstimator parameters_;
};

}  // namespace slalom::vehicle::detail
