#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "slalom/vehicle/estimation/parameter_estimator.hpp"
#include "slalom/vehicle/estimation/state_observer.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::vehicle::detail {

/// From sending a command to its first effect, s.
inline double delay_of(const PlannerOptions& options, const VehicleTraits& traits) {
  return options.latency + traits.dead_time;
}

/// State and parameters of a car whose tyres slip, for the planner. The steering of states and plans is the
/// angle of the wheels; commands to the car are larger where its steering gain is smaller than 1.
class CarEstimator {
 public:
  CarEstimator(const PlannerOptions& options, const VehicleModel& model)
      : identify_(options.estimation.identify),
        latency_(options.latency),
        steer_resolution_(options.steer_resolution),
        friction_(model.traits().friction),
        observer_(options.estimation.observer, options.control_period, options.latency,
                  model.traits().dead_time),
        parameters_(model.dynamics() ? std::make_unique<ParameterEstimator>(
                                           *model.dynamics(), options.estimation, model.traits().friction,
                                           delay_of(options, model.traits()), options.control_period)
                                     : nullptr) {}

  void reset() noexcept {
    observer_.reset();
    if (parameters_) parameters_->reset();
  }

  /// Takes the measurements of one control period after the last; the observer predicts with the mean of the
  /// friction.
  void update(VehicleModel& model, const ObserverInput& input) noexcept {
    ObserverInput checked = input;
    if (input.imu && !plausible(*input.imu)) checked.imu.reset();
    model.set_friction(friction());
    observer_.update(model, checked);
    if (!identify_ || !parameters_) return;
    const VehicleStart& car = observer_.now();
    parameters_->update({input.pose, car.speed, car.yaw_rate, car.slip});
    observer_.set_dead_time(std::max(0.0, parameters_->estimate().delay - latency_));
  }

  /// Records what is sent for this command of the wheels' angle, and returns it: an angle at which the
  /// steering settles.
  Command send(const Command& wheels, double steer_limit) noexcept {
    Command command = wheels;
    const double gain = identify_ && parameters_ ? parameters_->estimate().steering_gain : 1;
    command.steer = std::clamp(wheels.steer / gain, -steer_limit, steer_limit);
    if (const double step = steer_resolution_; step > 0) {
      const double most = std::floor(steer_limit / step);
      command.steer = step * std::clamp(std::round(command.steer / step), -most, most);
    }
    observer_.send({command.steer * gain, command.speed});
    if (parameters_) parameters_->send(command.steer);
    return command;
  }

  /// The mean of the friction.
  double friction() const noexcept {
    return identify_ && parameters_ ? parameters_->estimate().friction : friction_;
  }
  /// The friction on which plans rely.
  double cautious_friction() const noexcept {
    return identify_ && parameters_ ? parameters_->estimate().cautious_friction : friction_;
  }
  /// What is known of car and ground; the given values where nothing is learned.
  ParameterEstimate parameters() const noexcept {
    if (parameters_ && identify_) return parameters_->estimate();
    return {.friction = friction_, .cautious_friction = friction_};
  }
  /// Writes what is known into an output.
  void publish(PlannerOutput& output) const noexcept {
    const VehicleStart& now = observer_.now();
    output.speed_estimate = now.speed;
    output.yaw_rate_estimate = now.yaw_rate;
    output.slip_estimate = now.slip;
    output.parameters = parameters();
  }
  const StateObserver& state() const noexcept { return observer_; }

 private:
  bool identify_;
  double latency_, steer_resolution_, friction_;
  StateObserver observer_;
  std::unique_ptr<ParameterEstimator> parameters_;
};

}  // namespace slalom::vehicle::detail
