#include "slalom/evaluation/lap_runner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "evaluation/lap_state.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/evaluation/passability.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::evaluation {
namespace {

constexpr double timeout_laps = 3;          // laps of the profile
constexpr double published_control = 0.01;  // s of simulated time per command
constexpr double finish_tolerance = 0.5;    // m before the end of an open course

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

/// Where the rear axle of the simulated car is.
vehicle::Odometry odometry_of(const sim::Observation& seen, double rear_length) {
  const double c = std::cos(seen.pose.yaw), s = std::sin(seen.pose.yaw);
  return {{seen.pose.x - rear_length * c, seen.pose.y - rear_length * s, seen.pose.yaw}, seen.speed};
}

}  // namespace

std::uint64_t solver_seed(std::uint64_t lap_seed, std::string_view method) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a of the method's name
  for (const char c : method) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::uint64_t z = hash + lap_seed * 0x9e3779b97f4a7c15u;  // splitmix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

LapRunner::LapRunner(std::shared_ptr<const Environment> environment,
                     const vehicle::Configuration& configuration, std::string method,
                     const LapSettings& settings)
    : environment_(std::move(environment)),
      configuration_(configuration),
      method_(std::move(method)),
      settings_(settings) {
  require(environment_ != nullptr, "environment: a lap needs one");
  require(settings.obstacles >= 0 && settings.obstacles <= 1000,
          "obstacles: " + std::to_string(settings.obstacles) + " must be in [0, 1000]");
  validate_options(settings, "world");
  require(settings.threads >= 1 && settings.threads <= 1024,
          "threads: " + std::to_string(settings.threads) + " must be in [1, 1024]");
  const bool published = environment_->protocol == Protocol::published;
  if (published) {
    const auto standard = list_options(LapSettings{}), chosen = list_options(settings);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      require(chosen[i] == standard[i], std::string(chosen[i].declaration.name) + ": must be " +
                                            to_text(standard[i].value) + " in the published evaluation");
  }
  require(!published || !settings.hardware, "hardware: not in the published evaluation");
  if (settings.hardware) {
    validate_options(*settings.hardware, "hardware");
    settings.hardware->wheels.validate();
    settings.hardware->localiser.validate();
  }
  require(settings.opponents == 0 || environment_->course.closed,
          "opponents: must be 0 on courses that are no loops");
  path_ = environment_->path;
  for (maps::ReferencePoint& point : path_) point.speed *= settings.speed_scale;
  start_ = settings.start.value_or(environment_->start);
  vehicle::check_start(environment_->course, start_);
  make_planner();  // refuses what it does not like here and not in the first lap

  vehicle::Course capped;
  capped.waypoints = environment_->course.waypoints;
  capped.closed = environment_->course.closed;
  for (vehicle::Waypoint& point : capped.waypoints) point.speed *= settings.speed_scale;
  vehicle::cap_speed(capped, configuration_.planner.max_speed);
  timeout_ = environment_->timeout > 0 ? environment_->timeout : timeout_laps * vehicle::profile_time(capped);
  if (!environment_->course.closed && !published)
    open_length_ = environment_->course.length -
                   environment_->track->lap_path()->project({start_.x, start_.y}).arc - finish_tolerance;
}

double LapRunner::control_period() const noexcept {
  return environment_->protocol == Protocol::published ? published_control
                                                       : configuration_.planner.control_period;
}

std::unique_ptr<vehicle::Planner> LapRunner::make_planner() const {
  return std::make_unique<vehicle::Planner>(configuration_.planner,
                                            vehicle::make_vehicle_model(configuration_.vehicle), path_,
                                            vehicle::make_solver(configuration_, method_, settings_.threads));
}

std::vector<maps::Pose> LapRunner::place_obstacles(std::uint64_t lap_seed) const try {
  const std::uint64_t seed = settings_.layout.value_or(lap_seed);
  const auto& path = environment_->course.obstacle_path;
  const auto placed = environment_->protocol == Protocol::published
                          ? sim::place_as_published(path, settings_.obstacles, seed)
                          : sim::place_apart(path, environment_->obstacle_room, settings_.obstacles, seed,
                                             {start_.x, start_.y});
  std::vector<maps::Pose> poses;
  for (const sim::Placement& each : placed) poses.push_back(each.pose);
  return poses;
} catch (const std::runtime_error& error) {
  throw std::runtime_error("course " + environment_->course.name + ": " + error.what() +
                           "; beside each of them a passage must stay open, so the course may be too narrow");
}

/// Evenly round the course, where no obstacle stands.
std::vector<maps::Pose> LapRunner::place_opponents(const std::vector<maps::Pose>& obstacles) const {
  const sim::LapPath& path = *environment_->track->lap_path();
  const double begin = path.project({start_.x, start_.y}).arc, room = 1.0, step = 0.25;  // m
  std::vector<maps::Pose> poses;
  for (int i = 1; i <= settings_.opponents; ++i) {
    double arc = begin + path.length() * i / (settings_.opponents + 1);
    for (double tried = 0; tried < path.length(); tried += step, arc += step) {
      const maps::Pose pose = path.at(arc);
      const auto near = [&](const maps::Pose& other) {
        return std::hypot(other.x - pose.x, other.y - pose.y) < room;
      };
      if (std::any_of(obstacles.begin(), obstacles.end(), near) ||
          std::any_of(poses.begin(), poses.end(), near) || near(start_))
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

bool LapRunner::at_finish(const sim::World& world) const noexcept {
  if (environment_->protocol == Protocol::published) {
    // The published count takes a car that leaves the zone and backs into it for one that has been round.
    const sim::StartZoneLaps& zone = world.start_zone_laps(0);
    return zone.laps() > 0 && zone.near_start() && progress(world) > 0.5;
  }
  if (open_length_ > 0) return world.laps(0)->progress() >= open_length_;
  return world.laps(0)->laps() > 0;
}

double LapRunner::progress(const sim::World& world) const noexcept {
  const double length = open_length_ > 0 ? open_length_ : environment_->track->lap_path()->length();
  return std::clamp(world.laps(0)->progress() / length, 0.0, 1.0);
}

/// One planner update: what is seen goes in, the command is sent on its way.
void LapRunner::control(Drive& drive, const ControlStepCallback& on_step, double further_latency) const {
  const sim::Observation seen = drive.world.observe(0);
  const bool published = environment_->protocol == Protocol::published;
  maps::LaserScanView scan = seen.scan;
  if (published) {
    // The published simulator says that as many intervals as beams make up the field of view, in float32.
    const sim::LidarOptions& lidar = drive.world.lidar().options();
    scan.angle_min = static_cast<float>(lidar.angle_min());
    scan.angle_increment = static_cast<float>(lidar.field_of_view / lidar.beams);
  }
  vehicle::Odometry odometry = odometry_of(seen, drive.world.options().car.rear_length);
  bool placed = true;
  if (drive.hardware) {
    const auto sensed = drive.hardware->sense(seen, drive.world.state(0));
    placed = sensed.has_value();
    if (placed) odometry = *sensed;
  }
  // Without a pose the planner must be told so, and stops; what that costs is reckoned by the true one.
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const vehicle::PlannerOutput& output = drive.planner->update(
      {scan, placed ? odometry : vehicle::Odometry{{unknown, unknown, unknown}, odometry.speed}});

  // With the published maps planner and meter make the same cost map.
  drive.meter.observe(scan, odometry.pose,
                      configuration_.planner.published.maps ? &drive.planner->cost_map() : nullptr);
  const SequenceCostMeter::Cost cost = drive.meter.planned(output);
  drive.cost_state += cost.state;
  drive.cost_collision += cost.collision;
  if (settings_.additional_costs) {
    drive.cost_published += drive.meter.published_model(output).total();
    drive.cost_driven += drive.meter.present().total();
  }
  const auto width = static_cast<std::size_t>(output.inputs_per_step);  // the first input is the steering
  for (std::size_t row = 0; row < output.inputs.size(); row += width)
    drive.input_error += std::abs(static_cast<double>(output.inputs[row]));
  drive.speed += seen.speed;
  const double off_path = drive.meter.path_distance();
  drive.distance += off_path;
  LapResult& result = drive.result;
  result.max_path_distance = std::max(result.max_path_distance, off_path);
  ++result.planner_status[static_cast<std::size_t>(output.status)];
  result.tick_ms.push_back(static_cast<float>(1e3 * output.tick_time));
  if (output.solve) {
    const SolveResult& solve = *output.solve;
    ++drive.solves;
    drive.effective += solve.effective_sample_size;
    double variance = 0;
    for (std::size_t row = 0; row < solve.variances.size(); row += width)
      variance += static_cast<double>(solve.variances[row]);
    if (!solve.variances.empty())
      drive.variance += variance / static_cast<double>(solve.variances.size() / width);
    result.solve_ms.push_back(static_cast<float>(1e3 * solve.times.total));
  }
  if (on_step)
    on_step({result.steps, seen.time, progress(drive.world),
             published ? drive.log.published() : drive.log.collisions(), seen, scan, odometry, output,
             *drive.planner, drive.world, cost});
  ++result.steps;

  Command command{output.command.steer, output.command.speed};
  // The published program's messages carry float32.
  if (published) command = {static_cast<float>(command.steer), static_cast<float>(command.speed)};
  const double time_step = drive.world.options().time_step;
  const auto delay = std::llround(settings_.latency / time_step) +
                     static_cast<long long>(std::ceil(further_latency / time_step - 1e-9));
  drive.under_way.emplace_back(drive.world.steps() + delay, command);
}

/// The world goes on until the next command is due.
void LapRunner::advance(Drive& drive, bool past_finish) const {
  const double time_step = drive.world.options().time_step;
  const auto steps = std::max<long long>(1, std::llround(control_period() / time_step));
  LapResult& result = drive.result;
  for (long long k = 0; k < steps && (past_finish || !at_finish(drive.world)); ++k) {
    while (!drive.under_way.empty() && drive.under_way.front().first <= drive.world.steps()) {
      drive.acting = drive.under_way.front().second;
      drive.under_way.erase(drive.under_way.begin());
    }
    drive.commands[0] = drive.hardware ? drive.hardware->servo(drive.acting, time_step) : drive.acting;
    drive.commands[0].steer *= settings_.steering_gain;
    for (std::size_t i = 1; i < drive.commands.size(); ++i) {
      const sim::CarState& opponent = drive.world.state(i);
      drive.commands[i] = drive.opponents->command({opponent.x, opponent.y, opponent.yaw});
    }
    drive.world.step(drive.commands);
    if (drive.hardware) drive.hardware->moved(drive.world.state(0), time_step);
    const sim::Observation seen = drive.world.observe(0);
    if (!seen.collides()) continue;
    const auto touch = [&](int body) {
      const auto same = [&](const Collision& c) { return c.body == body; };
      if (std::none_of(result.first_collisions.begin(), result.first_collisions.end(), same))
        result.first_collisions.push_back({seen.time, seen.pose, body});
    };
    if (seen.wall) touch(-1);
    for (const int body : seen.colliding) touch(body);
    drive.log.update(drive.world, 0);
  }
  const sim::Box body = drive.world.outline(0);
  for (const maps::Point& corner : sim::corners(body))
    result.least_clearance = std::min(result.least_clearance, environment_->track->distance_to_wall(corner));
  for (std::size_t i = 1; i < drive.world.bodies(); ++i)
    result.least_clearance = std::min(result.least_clearance, sim::signed_gap(body, drive.world.outline(i)));
}

void LapRunner::finish(Drive& drive) const {
  LapResult& result = drive.result;
  const bool published = environment_->protocol == Protocol::published;
  result.finished = at_finish(drive.world);
  result.timeout = !result.finished && !result.cancelled;
  result.collisions = published ? drive.log.published() : drive.log.collisions();
  result.collided_bodies = drive.log.collisions();
  result.wall = drive.log.hit_wall();
  if (drive.hardware) result.localisation = drive.hardware->record();
  result.time = drive.world.time();
  if (result.finished && !published && open_length_ <= 0) result.time = drive.world.laps(0)->last_lap_time();
  if (result.steps == 0) return;
  const double n = result.steps;
  result.state_cost = drive.cost_state / n;
  result.collision_cost = drive.cost_collision / n;
  result.mean_sequence_cost = result.state_cost + result.collision_cost;
  result.published_model_cost = drive.cost_published / n;
  result.driven_cost = drive.cost_driven / n;
  result.input_error = drive.input_error / n;
  result.mean_speed = drive.speed / n;
  result.mean_path_distance = drive.distance / n;
  if (drive.solves > 0) {
    result.mean_variance = drive.variance / drive.solves;
    result.mean_effective_samples = drive.effective / drive.solves;
  }
}

std::unique_ptr<LapRunner::Drive> LapRunner::begin(std::uint64_t seed) const {
  sim::WorldOptions options = environment_->world_options();
  if (environment_->protocol == Protocol::true_physics) {
    // A whole number of physics steps and one scan per command, whatever the control period is.
    const double period = configuration_.planner.control_period;
    options.time_step = period / std::max(1.0, std::ceil(period / options.time_step - 1e-9));
    options.lidar.rate = 1 / period;
    options.lidar.noise = settings_.range_noise;
    options.lidar.dropout = settings_.dropout;
    options.car.friction = settings_.friction;
    if (settings_.saturating_tyres) options.plant.dynamics.model = sim::Model::saturating;
  }
  if (settings_.hardware) HardwareModel::apply(*settings_.hardware, options);
  auto drive = std::make_unique<Drive>(options, *environment_, path_, configuration_, make_planner());
  drive->planner->reset(solver_seed(seed, method_));
  drive->result.seed = seed;
  drive->result.obstacles = place_obstacles(seed);
  drive->result.least_clearance = std::numeric_limits<double>::infinity();
  std::vector<maps::Pose> cars{start_};
  if (settings_.opponents > 0) {
    std::vector<sim::PathPoint> line;
    for (const maps::ReferencePoint& point : path_)
      line.push_back({{point.x, point.y},
                      settings_.opponent_speed * std::min(point.speed, configuration_.planner.max_speed)});
    drive->opponents.emplace(std::move(line));
    const auto opponents = place_opponents(drive->result.obstacles);
    cars.insert(cars.end(), opponents.begin(), opponents.end());
    drive->commands.resize(cars.size());
  }
  drive->world.reset(seed, cars, drive->result.obstacles);
  std::vector<sim::Box> parked;
  for (std::size_t i = cars.size(); i < drive->world.bodies(); ++i) parked.push_back(drive->world.outline(i));
  drive->result.impassable = static_cast<int>(
      impassable_obstacles(*environment_->track, parked, {.radius = 0.5 * options.car.width}).size());
  for (std::size_t i = 1; i < cars.size(); ++i) drive->world.set_scanning(i, false);
  if (settings_.hardware)
    drive->hardware =
        std::make_unique<HardwareModel>(*settings_.hardware, environment_->course.map, options.car,
                                        drive->world.state(0), solver_seed(seed, "hardware"));
  return drive;
}

LapResult LapRunner::run(std::uint64_t seed, const ControlStepCallback& on_step,
                         const std::atomic<bool>* cancel) {
  const std::unique_ptr<Drive> drive = begin(seed);
  while (!at_finish(drive->world) && drive->world.time() <= timeout_) {
    if (cancel && cancel->load(std::memory_order_relaxed)) {
      drive->result.cancelled = true;
      break;
    }
    control(*drive, on_step);
    advance(*drive);
  }
  finish(*drive);
  return std::move(drive->result);
}

}  // namespace slalom::evaluation
