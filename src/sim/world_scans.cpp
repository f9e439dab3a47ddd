#include "slalom/sim/world.hpp"

namespace slalom::sim {

void World::scan_walls(Car& car) noexcept {
  const CarState& s = car.plant.state();
  car.sensor = lidar_.sensor_pose({s.x, s.y, s.yaw});
  car.scan_time = time_;
  lidar_.scan(*track_, car.sensor, car.ranges);
}

void World::cast_bodies(std::size_t index) noexcept {
  Car& car = cars_[index];
  for (std::size_t i = 0; i < cars_.size(); ++i)
    if (i != index) lidar_.cast(car.sensor, boxes_[i], car.ranges);
  for (const Fixed& body : fixed_) {
    if (body.disc_radius > 0)
      lidar_.cast(car.sensor, Disc{{body.box.pose.x, body.box.pose.y}, body.disc_radius}, car.ranges);
    else
      lidar_.cast(car.sensor, body.box, car.ranges);
  }
}

void World::add_noise(Car& car) noexcept {
  const LidarOptions& lidar = options_.lidar;
  if (lidar.noise == 0 && lidar.dropout == 0) return;
  if (!lidar.gym_noise) return car.noise.add(car.ranges, lidar.noise, lidar.range_max, lidar.dropout);
  for (double& range : car.ranges) range += lidar.noise * car.gym_noise.normal();
}

void World::scan_all() noexcept {
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    if (!cars_[i].scans) continue;
    scan_walls(cars_[i]);
    if (options_.lidar.gym_noise) add_noise(cars_[i]);
    cast_bodies(i);
    if (!options_.lidar.gym_noise) add_noise(cars_[i]);
  }
}

void World::gym_scan_and_contacts() noexcept {
  for (Car& car : cars_) {
    car.wall = false;
    if (!car.scans) continue;
    scan_walls(car);
    add_noise(car);
  }
  find_contacts();
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    Car& car = cars_[i];
    if (!car.scans) continue;
    car.wall = time_to_collision_.first_hit(car.ranges, car.plant.state().speed) >= 0;
    if (car.wall) {
      flags_[i] = 1;
      // The others still see it where it drove to; its own view of them is from its new yaw.
      const Box moved = boxes_[i];
      respond(i);
      boxes_[i] = moved;
      const CarState& s = car.plant.state();
      car.sensor = lidar_.sensor_pose({s.x, s.y, s.yaw});
    }
    cast_bodies(i);
  }
}

}  // namespace slalom::sim
