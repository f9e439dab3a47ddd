#include "evaluation/lap_setup.hpp"

#include "evaluation/driver/car_driver.hpp"
#include "evaluation/hardware_model.hpp"
#include "evaluation/lap_rules.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/vehicle/course/course_check.hpp"

namespace slalom::evaluation {
namespace {

constexpr double timeout_laps = 3;         // laps at the speed profile
constexpr double least_speed_share = 0.5;  // least factor of vehicle.speed_share

void check(const LapSettings& settings, const LapRules& rules, bool closed) {
  require(settings.obstacles >= 0 && settings.obstacles <= 1000,
          "obstacles: " + std::to_string(settings.obstacles) + " must be in [0, 1000]");
  require(std::ssize(settings.parked) <= settings.obstacles,
          "parked: has " + std::to_string(settings.parked.size()) + " places; must be at most obstacles, " +
              std::to_string(settings.obstacles));
  validate_options(settings, "world");
  require(settings.threads >= 1 && settings.threads <= 1024,
          "threads: " + std::to_string(settings.threads) + " must be in [1, 1024]");
  rules.check(settings);
  if (const auto hardware = hardware_of(settings)) {
    validate_options(*hardware, "hardware");
    validate_options(hardware->wheels, "wheel_odometry");
    validate_options(hardware->inertial, "imu");
    hardware->localiser.validate();
  } else {
    require(settings.localiser.empty(),
            "localiser: its options act only on a lap with --hardware or world.localised=true");
  }
  require(settings.opponents == 0 || closed,
          "world.opponents: " + std::to_string(settings.opponents) + " must be 0 on an open course");
  require(settings.rounds == 1 || closed,
          "world.rounds: " + std::to_string(settings.rounds) + " must be 1 on an open course");
  require(settings.opponent_speed.fits(std::max(settings.opponents, 1)),
          "world.opponent_speed: has " + std::to_string(settings.opponent_speed.values().size()) +
              " values, must have one, or one for each opponent");
  require(settings.planning_opponents <= settings.opponents,
          "world.planning_opponents: " + std::to_string(settings.planning_opponents) +
              " must be at most world.opponents, " + std::to_string(settings.opponents));
}

}  // namespace

void require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument(message);
}

std::uint64_t solver_seed(std::uint64_t lap_seed, std::string_view method) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a of the method's name
  for (const char c : method) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::uint64_t z = hash + lap_seed * 0x9e3779b97f4a7c15u;  // splitmix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

void check_settings(const LapSetup& setup) {
  require(setup.environment != nullptr, "environment: must not be null");
  const vehicle::Course& course = setup.environment->course;
  check(setup.settings, rules_of(setup.environment->protocol), course.closed);
  vehicle::check_start(course, setup.start());
}

void LapSetup::validate() const {
  check_settings(*this);
  make_planner(*this);
  for (int i = 0; i < settings.planning_opponents; ++i) setup_of_opponent(*this, i).validate();
}

maps::Pose LapSetup::start() const {
  return settings.start.value_or(environment->start);
}

double LapSetup::control_period() const noexcept {
  return rules_of(environment->protocol).control_period(driver.configuration);
}

double LapSetup::timeout() const {
  if (environment->timeout > 0) return environment->timeout * settings.rounds;
  const vehicle::Course& course = environment->course;
  vehicle::Course capped;
  capped.waypoints = course.waypoints;
  capped.closed = course.closed;
  for (vehicle::Waypoint& point : capped.waypoints) point.speed *= settings.speed_scale;
  const vehicle::PlannerOptions& planner = driver.configuration.planner;
  vehicle::cap_speed(capped, planner.max_speed);
  if (planner.profile_friction > 0)
    vehicle::make_feasible(capped, vehicle::grip_limits(planner.profile_friction, planner.max_speed,
                                                        driver.configuration.vehicle.max_acceleration,
                                                        driver.configuration.vehicle.max_deceleration));
  return timeout_laps * vehicle::profile_time(capped) * settings.rounds;
}

bool ends_with_path(const LapSetup& setup) noexcept {
  return !setup.environment->course.closed && rules_of(setup.environment->protocol).finishes_open_courses();
}

double LapSetup::length() const {
  const sim::LapPath& path = *environment->track->lap_path();
  if (!ends_with_path(*this)) return settings.rounds * path.length();
  const double arc = path.project(start()).arc, end = environment->course.length;
  // Beyond the end of an open path lies the way back to its beginning, where the first point may project.
  return end - (arc > end ? 0 : arc) - finish_tolerance;
}

sim::WorldOptions world_options(const LapSetup& setup) {
  sim::WorldOptions options = setup.environment->world_options();
  rules_of(setup.environment->protocol).configure(options, setup.settings, setup.driver.configuration);
  if (const auto conditions = hardware_of(setup.settings)) HardwareModel::apply(*conditions, options);
  return options;
}

long long steps_per_command(const LapSetup& setup, const sim::WorldOptions& world) noexcept {
  return std::max<long long>(1, std::llround(setup.control_period() / world.time_step));
}

std::vector<maps::ReferencePoint> path_of(const LapSetup& setup) {
  std::vector<maps::ReferencePoint> path = setup.environment->path;
  for (maps::ReferencePoint& point : path) point.speed *= setup.settings.speed_scale;
  return path;
}

vehicle::Planner make_planner(const LapSetup& setup) {
  const vehicle::Configuration& configuration = setup.driver.configuration;
  auto model = vehicle::make_vehicle_model(configuration.vehicle);
  vehicle::PlannerOptions options = configuration.planner;
  // A planner that estimates the car's motion must know the time between two updates. The paper's program
  // does not: its planner assumes 0.025 s where its simulator takes steps of 0.01 s.
  if (model->traits().tyres.friction > 0) options.control_period = setup.control_period();
  std::vector<maps::ReferencePoint> path = path_of(setup);
  for (maps::ReferencePoint& point : path) point.speed *= setup.driver.speed_share;
  return {options, std::move(model), path,
          vehicle::make_solver(configuration, setup.driver.method, setup.settings.threads)};
}

LapSetup setup_of_opponent(const LapSetup& setup, int index) {
  LapSetup own = setup;
  if (setup.settings.opponent_planner) own.driver = *setup.settings.opponent_planner;
  LapSettings& settings = own.settings;
  settings.obstacles = settings.opponents = 0;
  settings.parked.clear();
  settings.planning_opponents = 0;
  settings.opponent_speed = 1;
  const double share = own.driver.speed_share = setup.settings.opponent_speed[index];
  vehicle::Configuration& configuration = own.driver.configuration;
  configuration.planner.control_period = setup.driver.configuration.planner.control_period;
  if (vehicle::make_vehicle_model(configuration.vehicle)->traits().tyres.seeks_lap_time) {
    auto& speed_share = configuration.vehicle.own_of<vehicle::SingleTrackOptions>().speed_share;
    speed_share *= share;
    if (speed_share < least_speed_share)
      throw std::invalid_argument("world.opponent_speed: " + std::to_string(share) +
                                  " is too slow for an opponent that plans with vehicle.objective lap_time: "
                                  "times vehicle.speed_share it must be at least 0.5");
  } else {
    configuration.planner.max_speed *= share;
    configuration.vehicle.reference_speed *= share;
  }
  return own;
}

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
  const double begin = path.project(start).arc;
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
    const bool plans = i < settings.planning_opponents;
    drive.world.set_scanning(number, plans);
    if (plans) {
      drive.drivers.emplace_back(number, PlanningDriver(setup_of_opponent(setup, i), drive.world, number,
                                                        seed, " of opponent " + std::to_string(i)));
      continue;
    }
    const double share = settings.opponent_speed[i];
    if (settings.opponent_driver == sim::OpponentDriver::pursuit) {
      std::vector<sim::PathPoint> slower = path;
      for (sim::PathPoint& point : slower) point.speed *= share;
      drive.drivers.emplace_back(number, sim::PurePursuit(std::move(slower)));
      continue;
    }
    if (!line) line = std::make_shared<const sim::RacingLine>(path, *setup.environment->track, car, parked);
    const RandomKey key{solver_seed(seed, "opponents"), static_cast<std::uint64_t>(i)};
    drive.drivers.emplace_back(number,
                               sim::RacingOpponent(line, number, settings.opponent_driver, share, key));
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
