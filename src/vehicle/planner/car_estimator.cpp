#include "vehicle/planner/car_estimator.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {

CarEstimator::CarEstimator(const PlannerOptions& options, const DynamicVehicleModel& model)
    : identify_(options.estimation.identify),
      latency_(options.latency),
      steer_resolution_(options.steer_resolution),
      friction_(model.traits().tyres.friction),
      observer_(options.estimation, options.control_period, options.latency, model.traits().dead_time),
      parameters_(model.dynamics(), options.estimation, model.traits().tyres.friction,
                  options.latency + model.traits().dead_time, options.control_period) {}

void CarEstimator::reset() noexcept {
  observer_.reset();
  parameters_.reset();
}

void CarEstimator::update(const DynamicVehicleModel& model, const ObserverInput& input) noexcept {
  ObserverInput checked = input;
  if (input.imu && !plausible(*input.imu)) checked.imu.reset();
  observer_.update(model, checked, parameters().friction);
  if (!identify_) return;
  const VehicleStart& car = observer_.now();
  parameters_.update({input.pose, car.speed, car.yaw_rate, car.slip});
  observer_.set_dead_time(std::max(0.0, parameters_.estimate().delay - latency_));
}

Command CarEstimator::command(const Command& wheels, double steer_limit) const noexcept {
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

void CarEstimator::send(const Command& command) noexcept {
  const ParameterEstimate car = parameters();
  observer_.send({command.steer * car.steering_gain + car.steering_offset, command.speed});
  parameters_.send(command.steer);
}

ParameterEstimate CarEstimator::parameters() const noexcept {
  if (identify_) return parameters_.estimate();
  return {.friction = friction_, .cautious_friction = friction_};
}

}  // namespace slalom::vehicle::detail
