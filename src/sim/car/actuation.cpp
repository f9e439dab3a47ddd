#include "slalom/sim/actuation.hpp"

#include <algorithm>
#include <cmath>

#include "sim/validation.hpp"

namespace slalom::sim {

void ActuationOptions::validate() const {
  detail::require_positive("speed_gain", speed_gain);
  detail::require_positive("brake_gain", brake_gain);
}

double steer_rate_towards(const CarParameters& car, const ActuationOptions& options, double steer,
                          double target, double time_step) noexcept {
  if (options.gym.steering) {
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
  if (options.gym.gains) {
    const double factor = speed > 0 ? 10.0 : 2.0;
    const double range = difference > 0 ? car.speed_max : -car.speed_min;
    return factor * car.acceleration_max / range * difference;
  }
  // Braking is slowing down whichever way the car goes.
  const bool brakes = speed != 0 && (difference > 0) != (speed > 0);
  return (brakes ? options.brake_gain : options.speed_gain) * difference;
}

}  // namespace slalom::sim
