#include "slalom/sim/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/validation.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;

double wrap(double yaw, bool gym) {
  if (!gym) return yaw > pi || yaw < -pi ? std::remainder(yaw, 2 * pi) : yaw;
  if (yaw > 2 * pi) return yaw - 2 * pi;
  return yaw < 0 ? yaw + 2 * pi : yaw;
}

}  // namespace

Plant::Plant(const CarParameters& car, const PlantOptions& options, double time_step)
    : car_(car), options_(options), time_step_(time_step) {
  car.validate();
  options.actuation.validate();
  detail::require_range("time_step", time_step, 1e-5, 0.1);
  detail::require_range("steering_dead_time", options.steering_dead_time, 0, 1);
  detail::require_range("substeps", options.dynamics.substeps, 0, 1000);
  if (options.actuation.gym.gains)
    detail::require_range("speed_min with gym.gains", car.speed_min, -1000, -1e-3);
  on_the_way_.assign(static_cast<std::size_t>(std::lround(options.steering_dead_time / time_step)), 0.0);
  options_.dynamics.substeps = substeps(car, options.dynamics, time_step);
}

void Plant::reset(const CarState& state) noexcept {
  state_ = state;
  last_ = {};
  applied_ = 0;
  next_ = 0;
  std::fill(on_the_way_.begin(), on_the_way_.end(), 0.0);
}

double Plant::delayed(double steering) noexcept {
  if (on_the_way_.empty()) return steering;
  const double due = on_the_way_[next_];
  on_the_way_[next_] = steering;
  next_ = next_ + 1 == on_the_way_.size() ? 0 : next_ + 1;
  return due;
}

void Plant::move(const DriveInput& input) noexcept {
  state_ = advance(car_, options_.dynamics, state_, input, time_step_);
  state_.yaw = wrap(state_.yaw, options_.gym.yaw);
}

void Plant::step(const Command& command) noexcept {
  if (!std::isfinite(command.steer) || !std::isfinite(command.speed)) return coast();
  last_ = command;
  applied_ = delayed(command.steer);
  DriveInput input{applied_, command.speed};
  if (options_.steering_input == SteeringInput::angle)
    input.steer_rate = steer_rate_towards(car_, options_.actuation, state_.steer, applied_, time_step_);
  if (options_.speed_input == SpeedInput::speed)
    input.acceleration = acceleration_towards(car_, options_.actuation, state_.speed, command.speed);
  move(input);
}

void Plant::coast() noexcept {
  if (options_.coast == Coast::repeat) return step(last_);
  // Commands under way still arrive; after them the wheels stay as they are.
  const double hold = options_.steering_input == SteeringInput::angle ? state_.steer : 0.0;
  applied_ = delayed(hold);
  DriveInput input{applied_, 0};
  if (options_.steering_input == SteeringInput::angle)
    input.steer_rate = steer_rate_towards(car_, options_.actuation, state_.steer, applied_, time_step_);
  if (options_.coast == Coast::brake)
    input.acceleration =
        std::clamp(-state_.speed / time_step_, -car_.acceleration_max, car_.acceleration_max);
  move(input);
}

}  // namespace slalom::sim
