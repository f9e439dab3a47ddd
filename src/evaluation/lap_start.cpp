// The start of a lap: its world, and the positions of obstacles and opponents.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "evaluation/lap_in_progress.hpp"
#include "evaluation/lap_rules.hpp"
#include "slalom/evaluation/passability.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::evaluation {
namespace {

constexpr double least_speed_share = 0.5;  // of vehicle.speed_share

}  // namespace

std::vector<maps::Pose> LapRunner::place_obstacles(std::uint64_t lap_seed) const try {
  const auto placed =
      rules_of(environment_->protocol)
          .place_obstacles(*environment_, settings_.obstacles, settings_.layout.value_or(lap_seed),
                           {start_.x, start_.y}, sim::parameters_of(settings_.car));
  std::vector<maps::Pose> poses;
  for (const sim::Placement& each : placed) poses.push_back(each.pose);
  return poses;
} catch (const std::runtime_error& error) {
  throw std::runtime_error("course " + environment_->course.name + ": " + error.what() +
                           "; the course may be too narrow to pass a parked car");
}

/// At equal distances along the course, or one after the other ahead of the start. A position less than 1 m
/// from another car is moved forward.
std::vector<maps::Pose> LapRunner::place_opponents(const std::vector<maps::Pose>& obstacles) const {
  const sim::LapPath& path = *environment_->track->lap_path();
  const double begin = path.project({start_.x, start_.y}).arc;
  const double min_distance = 1.0, step = 0.25;  // m
  std::vector<maps::Pose> poses;
  for (int i = 1; i <= settings_.opponents; ++i) {
    double arc = begin + (settings_.opponent_gap > 0 ? settings_.opponent_gap * i
                                                     : path.length() * i / (settings_.opponents + 1));
    for (double tried = 0; tried < path.length(); tried += step, arc += step) {
      const maps::Pose pose = path.at(arc);
      const auto is_near = [&](const maps::Pose& other) {
        return std::hypot(other.x - pose.x, other.y - pose.y) < min_distance;
      };
      if (std::any_of(obstacles.begin(), obstacles.end(), is_near) ||
          std::any_of(poses.begin(), poses.end(), is_near) || is_near(start_))
        continue;
      poses.push_back(pose);
      break;
    }
  }
  if (static_cast<int>(poses.size()) < settings_.opponents)
    throw std::runtime_error("course " + environment_->course.name + ": no room for " +
                             std::to_string(settings_.opponents) + " opponents");
  return poses;
}

/// What drives an opponent that has a planner. World and sensors are those of the car.
std::shared_ptr<const LapRunner> LapRunner::planning_opponent(int index) const {
  const double share = settings_.opponent_speed[index];
  OpponentPlanner driver =
      settings_.opponent_planner ? *settings_.opponent_planner : OpponentPlanner{configuration_, method_};
  vehicle::Configuration& configuration = driver.configuration;
  configuration.planner.control_period = configuration_.planner.control_period;
  LapSettings settings = settings_;
  settings.obstacles = settings.opponents = 0;
  settings.blocking_opponents = settings.erratic_opponents = settings.planning_opponents = 0;
  settings.opponent_speed = 1;
  const bool ignores_path_speeds =
      vehicle::make_vehicle_model(configuration.vehicle)->traits().seeks_lap_time;
  if (ignores_path_speeds) {
    auto& own = configuration.vehicle.own_of<vehicle::SingleTrackOptions>();
    own.speed_share *= share;
    if (own.speed_share < least_speed_share)
      throw std::invalid_argument("world.opponent_speed: " + std::to_string(share) +
                                  " is too slow for an opponent that plans with vehicle.objective lap_time: "
                                  "times vehicle.speed_share it must be at least 0.5");
  } else {
    configuration.planner.max_speed *= share;
    configuration.vehicle.reference_speed *= share;
  }
  const auto runner = std::make_shared<LapRunner>(environment_, configuration, driver.method, settings);
  runner->speed_share_ = share;
  return runner;
}

/// The drivers of the opponents, in a world that has been reset; those that look share one line.
void LapRunner::make_opponents(LapInProgress& lap) const {
  const sim::CarParameters& car = lap.world.options().car;
  std::vector<sim::PathPoint> path;
  for (const maps::ReferencePoint& point : path_)
    path.push_back({{point.x, point.y}, std::min(point.speed, configuration_.planner.max_speed)});
  std::vector<sim::Box> parked;
  for (const maps::Pose& pose : lap.result.obstacles) parked.push_back({pose, car.length, car.width});
  std::shared_ptr<const sim::RacingLine> line;
  lap.planning_opponents = planning_opponents_;
  auto planning = lap.planning_opponents.begin();
  for (int i = 0; i < settings_.opponents; ++i) {
    const auto number = static_cast<std::size_t>(i) + 1;
    lap.world.set_scanning(number, has_planner(settings_, i));
    if (has_planner(settings_, i)) {
      lap.opponents.emplace_back(std::in_place_type<DriverStack>, **planning++, lap.world, number,
                                 lap.result.seed, " of opponent " + std::to_string(i));
      continue;
    }
    const double share = settings_.opponent_speed[i];
    const sim::OpponentDriver driver = driver_of(settings_, i);
    if (driver == sim::OpponentDriver::pursuit) {
      std::vector<sim::PathPoint> slower = path;
      for (sim::PathPoint& point : slower) point.speed *= share;
      lap.opponents.emplace_back(std::in_place_type<sim::PurePursuit>, std::move(slower));
      continue;
    }
    if (!line) line = std::make_shared<const sim::RacingLine>(path, *environment_->track, car, parked);
    lap.opponents.emplace_back(
        std::in_place_type<sim::RacingOpponent>, line, number,
        sim::RacingOpponentOptions{.driver = driver, .speed_share = share},
        RandomKey{solver_seed(lap.result.seed, "opponents"), static_cast<std::uint64_t>(i)});
  }
}

std::unique_ptr<LapRunner::LapInProgress> LapRunner::begin(std::uint64_t seed) const {
  const sim::WorldOptions options = DriverStack::world_options(*this);
  auto lap = std::make_unique<LapInProgress>(options, *environment_, path_, configuration_);
  lap->result.seed = seed;
  lap->result.obstacles = place_obstacles(seed);
  lap->result.min_clearance = std::numeric_limits<double>::infinity();
  std::vector<maps::Pose> cars{start_};
  if (settings_.opponents > 0) {
    const auto opponents = place_opponents(lap->result.obstacles);
    cars.insert(cars.end(), opponents.begin(), opponents.end());
    lap->commands.resize(cars.size());
  }
  lap->world.reset(seed, cars, lap->result.obstacles);
  if (settings_.opponents > 0) {
    make_opponents(*lap);
    lap->overtaking = std::make_unique<OvertakingMeter>(lap->world);
  }
  std::vector<sim::Box> parked;
  for (std::size_t i = cars.size(); i < lap->world.bodies(); ++i) parked.push_back(lap->world.outline(i));
  lap->result.impassable = static_cast<int>(
      impassable_obstacles(*environment_->track, parked, {.radius = 0.5 * options.car.width}).size());
  lap->driver.emplace(*this, lap->world, 0, seed);
  return lap;
}

}  // namespace slalom::evaluation
