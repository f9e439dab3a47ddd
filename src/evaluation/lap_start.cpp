#include "evaluation/lap_start.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "evaluation/lap_setup.hpp"

namespace slalom::evaluation {
namespace {

std::vector<maps::Pose> place_obstacles(const LapSetup& setup, std::uint64_t lap_seed) try {
  const maps::Pose start = setup.start();
  const LapSettings& settings = setup.settings;
  std::vector<maps::Pose> places = settings.parked;
  const auto others =
      rules_of(setup.environment->protocol)
          .place_obstacles(*setup.environment, settings.obstacles - static_cast<int>(places.size()),
                           settings.layout.value_or(lap_seed), {start.x, start.y},
                           car_of(settings, setup.driver.configuration));
  places.insert(places.end(), others.begin(), others.end());
  return places;
} catch (const std::runtime_error& error) {
  throw std::runtime_error("course " + setup.environment->course.name + ": " + error.what() +
                           "; the course may be too narrow to pass a parked car");
}

/// Returns positions at equal distances along the course, or with `opponent_gap` ahead of the start and this
/// far apart. A position less than 1 m from another car is moved forward.
std::vector<maps::Pose> place_opponents(const LapSetup& setup, const std::vector<maps::Pose>& obstacles) {
  const sim::LapPath& path = *setup.environment->track->lap_path();
  const LapSettings& settings = setup.settings;
  const maps::Pose start = setup.start();
  const double begin = path.project({start.x, start.y}).arc;
  const double min_distance = 1.0, step = 0.25;  // m
  std::vector<maps::Pose> poses;
  for (int i = 1; i <= settings.opponents; ++i) {
    double arc = begin + (settings.opponent_gap > 0 ? settings.opponent_gap * i
                                                    : path.length() * i / (settings.opponents + 1));
    for (double tried = 0; tried < path.length(); tried += step, arc += step) {
      const maps::Pose pose = path.at(arc);
      const auto is_near = [&](const maps::Pose& other) {
        return std::hypot(other.x - pose.x, other.y - pose.y) < min_distance;
      };
      if (std::any_of(obstacles.begin(), obstacles.end(), is_near) ||
          std::any_of(poses.begin(), poses.end(), is_near) || is_near(start))
        continue;
      poses.push_back(pose);
      break;
    }
  }
  if (static_cast<int>(poses.size()) < settings.opponents)
    throw std::runtime_error("course " + setup.environment->course.name + ": no room for " +
                             std::to_string(settings.opponents) + " opponents");
  return poses;
}

/// Adds the drivers of the opponents to a drive whose world has been reset. All `RacingOpponent`s share one
/// racing line.
void add_opponents(CarDrive& drive, const LapSetup& setup, std::uint64_t seed,
                   const std::vector<maps::Pose>& obstacles) {
  const LapSettings& settings = setup.settings;
  const sim::CarParameters& car = drive.world.options().car;
  std::vector<sim::PathPoint> path;
  for (const maps::ReferencePoint& point : path_of(setup))
    path.push_back({{point.x, point.y}, std::min(point.speed, setup.driver.configuration.planner.max_speed)});
  std::vector<sim::Box> parked;
  for (const maps::Pose& pose : obstacles) parked.push_back({pose, car.length, car.width});
  std::shared_ptr<const sim::RacingLine> line;
  for (int i = 0; i < settings.opponents; ++i) {
    const auto number = static_cast<std::size_t>(i) + 1;
    drive.world.set_scanning(number, has_planner(settings, i));
    if (has_planner(settings, i)) {
      drive.drivers.emplace_back(number, PlanningDriver(setup_of_opponent(setup, i), drive.world, number,
                                                        seed, " of opponent " + std::to_string(i)));
      continue;
    }
    const double share = settings.opponent_speed[i];
    const sim::OpponentDriver driver = driver_of(settings, i);
    if (driver == sim::OpponentDriver::pursuit) {
      std::vector<sim::PathPoint> slower = path;
      for (sim::PathPoint& point : slower) point.speed *= share;
      drive.drivers.emplace_back(number, sim::PurePursuit(std::move(slower)));
      continue;
    }
    if (!line) line = std::make_shared<const sim::RacingLine>(path, *setup.environment->track, car, parked);
    const RandomKey key{solver_seed(seed, "opponents"), static_cast<std::uint64_t>(i)};
    drive.drivers.emplace_back(number, sim::RacingOpponent(line, number, driver, share, key));
  }
}

}  // namespace

CarDrive start_lap(const LapSetup& setup, std::uint64_t seed, std::vector<maps::Pose>& obstacles) {
  const sim::WorldOptions options = world_options(setup);
  CarDrive drive{sim::World(options, setup.environment->track), {}, steps_per_command(setup, options)};
  obstacles = place_obstacles(setup, seed);
  std::vector<maps::Pose> cars{setup.start()};
  const auto opponents = place_opponents(setup, obstacles);
  cars.insert(cars.end(), opponents.begin(), opponents.end());
  drive.world.reset(seed, cars, obstacles);
  drive.drivers.emplace_back(std::size_t{0}, PlanningDriver(setup, drive.world, 0, seed));
  add_opponents(drive, setup, seed, obstacles);
  return drive;
}

}  // namespace slalom::evaluation
