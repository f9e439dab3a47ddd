#pragma once

#include "slalom/vehicle/planner/planner.hpp"
#include "vehicle/estimation/parameter_estimator.hpp"
#include "vehicle/estimation/state_observer.hpp"

namespace slalom::vehicle::detail {

/// Estimates state and parameters of a car whose tyres slip. States and plans hold the angle of the wheels. A
/// command is this angle less the car's steering offset, divided by its steering gain.
class CarEstimator {
 public:
  CarEstimator(const PlannerOptions& options, const DynamicVehicleModel& model);

  void reset() noexcept;

  /// Takes the measurements one control period after the last ones. Predictions use the mean friction.
  void update(const DynamicVehicleModel& model, const ObserverInput& input) noexcept;

  /// Returns the command for this angle of the wheels, rounded to the resolution of the steering.
  Command command(const Command& wheels, double steer_limit) const noexcept;

  /// Records the command that the car obeys from now on.
  void send(const Command& command) noexcept;

  /// Returns the estimate of car and ground, or the given values if nothing is learned.
  ParameterEstimate parameters() const noexcept;
  const StateObserver& state() const noexcept { return observer_; }

 private:
  bool identify_;
  double latency_, steer_resolution_, friction_;
  StateObserver observer_;
  ParameterEstimator parameters_;
};

}  // namespace slalom::vehicle::detail
