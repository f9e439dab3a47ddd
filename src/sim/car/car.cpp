#include "slalom/sim/car.hpp"

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

}  // namespace slalom::sim
