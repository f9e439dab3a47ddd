#include <algorithm>

#include "slalom/sim/world.hpp"

namespace slalom::sim {

void World::scan_walls(DrivenCar& car) noexcept {
  car.sensor = lidar_.sensor_pose(car.plant.state().pose());
  car.scan_time = time_;
  if (options_.gym)
    lidar_.gym_scan(*track_, car.sensor, car.gym_ranges);
  else
    lidar_.scan(*track_, car.sensor, car.ranges);
}

void World::cast_bodies(std::size_t index) noexcept {
  DrivenCar& car = cars_[index];
  const auto cast = [&](const auto& body) {
    if (options_.gym)
      lidar_.gym_cast(car.sensor, body, car.gym_ranges);
    else
      lidar_.cast(car.sensor, body, car.ranges);
  };
  for (std::size_t i = 0; i < cars_.size(); ++i)
    if (i != index && !cars_[i].away) cast(boxes_[i]);
  for (const Fixed& body : fixed_) {
    if (body.disc_radius > 0)
      cast(body.disc());
    else
      cast(body.box);
  }
}

void World::add_noise(DrivenCar& car) noexcept {
  const LidarOptions& lidar = options_.lidar;
  if (lidar.noise == 0 && lidar.dropout == 0) return;
  if (options_.gym)
    for (double& range : car.gym_ranges) range += lidar.noise * car.gym_noise.normal();
  else
    car.noise.add(car.ranges, lidar.beams, lidar.noise, lidar.range_max, lidar.dropout);
}

void World::publish(DrivenCar& car) noexcept {
  std::transform(car.gym_ranges.begin(), car.gym_ranges.end(), car.ranges.begin(),
                 [](double range) { return static_cast<float>(range); });
}

void World::scan_if_due() noexcept {
  if (steps_ % scan_every_ != 0) return;
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    if (!cars_[i].scans || cars_[i].away) continue;
    scan_walls(cars_[i]);
    if (options_.gym) add_noise(cars_[i]);
    cast_bodies(i);
    publish(cars_[i]);
    if (!options_.gym) add_noise(cars_[i]);
  }
}

/// The order of f1tenth_gym: all cars scan the walls; a car that its scan shows to be at a wall stops; the
/// others enter its scan.
void World::gym_scan_and_collisions() noexcept {
  for (DrivenCar& car : cars_) {
    car.wall = false;
    if (!car.scans || car.away) continue;
    scan_walls(car);
    add_noise(car);
  }
  find_collisions();
  // Other cars still see a car that stops where it drove to. It sees them from its new yaw.
  const auto stop_at_wall = [&](std::size_t i) {
    cars_[i].wall = true;
    flags_[i] = 1;
    const Box moved = boxes_[i];
    respond(i);
    boxes_[i] = moved;
    cars_[i].sensor = lidar_.sensor_pose(cars_[i].plant.state().pose());
  };
  for (std::size_t i = 0; i < cars_.size(); ++i) {
    DrivenCar& car = cars_[i];
    if (!car.scans || car.away) continue;
    if (time_to_collision_.first_hit(car.gym_ranges, car.plant.state().speed) >= 0) stop_at_wall(i);
    cast_bodies(i);
    publish(car);
  }
}

}  // namespace slalom::sim
