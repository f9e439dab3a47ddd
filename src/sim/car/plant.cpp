#include "slalom/sim/plant.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;

double wrap(double yaw, bool gym) {
  if (!gym) return yaw > pi || yaw < -pi ? std::remainder(yaw, 2 * pi) : yaw;
  if (yaw > 2 * pi) return yaw - 2 * pi;
  return yaw < 0 ? yaw + 2 * pi : yaw;
}

}  // namespace

double steer_rate_towards(const CarParameters& car, const ActuationOptions& options, double steer,
                          double target, double time_step) noexcept {
  if (options.gym) {
    const double difference = target - steer;
    if (std::abs(difference) <= 1e-4) return 0;
    return difference > 0 ? car.steer_rate_max : -car.steer_rate_max;
  }
  const double difference = std::clamp(target, car.steer_min, car.steer_max) - steer;
  return std::clamp(difference / time_step, -car.steer_rate_max, car.steer_rate_max);
}

double acceleration_towards(const CarParameters& car, const ActuationOptions& options, double speed,
                            double target) noexcept {
  const double difference = target - speed;
  if (options.gym) {
    const double factor = speed > 0 ? 10.0 : 2.0;
    const double range = difference > 0 ? car.speed_max : -car.speed_min;
    return factor * car.acceleration_max / range * difference;
  }
  // Braking is slowing down whichever way the car goes.
  const bool brakes = speed != 0 && (difference > 0) != (speed > 0);
  return (brakes ? options.brake_gain : options.speed_gain) * difference;
}

Plant::Plant(const CarParameters& car, const PlantOptions& options, double time_step)
    : car_(car), options_(options), time_step_(time_step) {
  validate_options(car, "car");
  validate_options(options, "plant");
  slalom::detail::check("plant", {"time_step", "s", "", 1e-5, 0.1}, time_step);
  if (options.actuation.gym)
    slalom::detail::check("car", {"speed_min", "m/s", "", -1000, -1e-3}, car.speed_min);
  on_the_way_.assign(saturate_cast<std::size_t>(std::round(options.steering_dead_time / time_step)), 0.0);
  options_.dynamics.substeps = substeps(car, options.dynamics, time_step);
  slalom::detail::check("car", {"parts of a step that keep its tyres stable", "", "", 1, 1e4},
                        options_.dynamics.substeps);
}

void Plant::reset(const CarState& state) noexcept {
  state_ = state;
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
  state_.yaw = wrap(state_.yaw, options_.gym);
}

void Plant::step(const Command& command) noexcept {
  if (!std::isfinite(command.steer) || !std::isfinite(command.speed)) return coast();
  applied_ = delayed(command.steer);
  move({steer_rate_towards(car_, options_.actuation, state_.steer, applied_, time_step_),
        acceleration_towards(car_, options_.actuation, state_.speed, command.speed)});
}

void Plant::coast() noexcept {
  // Commands under way still arrive; after them the wheels stay as they are.
  applied_ = delayed(state_.steer);
  move({steer_rate_towards(car_, options_.actuation, state_.steer, applied_, time_step_), 0});
}

}  // namespace slalom::sim
