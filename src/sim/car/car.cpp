#include "slalom/sim/car.hpp"

#include "sim/validation.hpp"

namespace slalom::sim {

CarParameters CarParameters::full_scale() {
  CarParameters car;
  car.cornering_front = car.cornering_rear = 20.898083706740398;
  car.front_length = 1.1561957064;
  car.rear_length = 1.4227170936;
  car.gravity_height = 0.61373004;
  car.mass = 1093.2952334674046;
  car.inertia = 1791.5995300122856;
  car.steer_min = -1.066;
  car.steer_max = 1.066;
  car.steer_rate_max = 0.4;
  car.acceleration_max = 11.5;
  car.speed_min = -13.6;
  car.speed_max = 50.8;
  car.length = 4.508;
  car.width = 1.610;
  return car;
}

CarParameters parameters_of(CarKind kind) {
  return kind == CarKind::passenger_car ? CarParameters::full_scale() : CarParameters{};
}

void CarParameters::validate() const {
  detail::require_positive("friction", friction);
  detail::require_positive("cornering_front", cornering_front);
  detail::require_positive("cornering_rear", cornering_rear);
  detail::require_positive("front_length", front_length);
  detail::require_positive("rear_length", rear_length);
  detail::require_range("gravity_height", gravity_height, 0, 10);
  detail::require_positive("mass", mass);
  detail::require_positive("inertia", inertia);
  detail::require_range("steer_min", steer_min, -1.5, 0);
  detail::require_range("steer_max", steer_max, 0, 1.5);
  detail::require_positive("steer_rate_max", steer_rate_max);
  detail::require_positive("switch_speed", switch_speed);
  detail::require_positive("acceleration_max", acceleration_max);
  detail::require_range("speed_min", speed_min, -1000, 0);
  detail::require_positive("speed_max", speed_max);
  detail::require_positive("length", length);
  detail::require_positive("width", width);
}

}  // namespace slalom::sim
