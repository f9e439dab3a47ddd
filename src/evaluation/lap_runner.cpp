#include "slalom/evaluation/lap_runner.hpp"

#include <algorithm>
#include <stdexcept>

#include "evaluation/lap_in_progress.hpp"
#include "evaluation/lap_rules.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/vehicle/course/course_check.hpp"

namespace slalom::evaluation {
namespace {

constexpr double timeout_laps = 3;        // laps at the speed profile
constexpr double finish_tolerance = 0.5;  // m before the end of an open course

void require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument(message);
}

void check(const LapSettings& settings, const LapRules& rules, bool closed) {
  require(settings.obstacles >= 0 && settings.obstacles <= 1000,
          "obstacles: " + std::to_string(settings.obstacles) + " must be in [0, 1000]");
  validate_options(settings, "world");
  require(settings.threads >= 1 && settings.threads <= 1024,
          "threads: " + std::to_string(settings.threads) + " must be in [1, 1024]");
  rules.check(settings);
  if (settings.hardware) {
    validate_options(*settings.hardware, "hardware");
    settings.hardware->wheels.validate();
    settings.hardware->inertial.validate();
    settings.hardware->localiser.validate();
  }
  require(settings.opponents == 0 || closed,
          "world.opponents: " + std::to_string(settings.opponents) + " must be 0 on an open course");
  require(settings.rounds == 1 || closed,
          "world.rounds: " + std::to_string(settings.rounds) + " must be 1 on an open course");
  const int others = std::max(settings.opponents, 1),
            special = settings.blocking_opponents + settings.erratic_opponents + settings.planning_opponents;
  require(settings.opponent_speed.fits(others), "world.opponent_speed: has " +
                                                    std::to_string(settings.opponent_speed.values().size()) +
                                                    " values, must have one, or one for each opponent");
  require(special <= settings.opponents,
          "world.blocking_opponents, world.erratic_opponents and world.planning_opponents: together " +
              std::to_string(special) + ", must be at most world.opponents, " +
              std::to_string(settings.opponents));
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
  require(environment_ != nullptr, "environment: must not be null");
  if (settings.localised && !settings_.hardware)
    settings_.hardware = HardwareConditions::sensors(settings.range_noise, settings.dropout);
  const vehicle::Course& course = environment_->course;
  const LapRules& rules = rules_of(environment_->protocol);
  check(settings, rules, course.closed);
  path_ = environment_->path;
  for (maps::ReferencePoint& point : path_) point.speed *= settings.speed_scale;
  start_ = settings.start.value_or(environment_->start);
  vehicle::check_start(course, start_);
  make_planner();  // reports invalid options here and not in the first lap
  for (int i = 0; i < settings_.opponents; ++i)
    if (has_planner(settings_, i)) planning_opponents_.push_back(planning_opponent(i));

  vehicle::Course capped;
  capped.waypoints = course.waypoints;
  capped.closed = course.closed;
  for (vehicle::Waypoint& point : capped.waypoints) point.speed *= settings.speed_scale;
  vehicle::cap_speed(capped, configuration_.planner.max_speed);
  if (const auto& planner = configuration_.planner; planner.profile_friction > 0)
    vehicle::make_feasible(capped, vehicle::grip_limits(planner.profile_friction, planner.max_speed,
                                                        configuration_.vehicle.max_acceleration,
                                                        configuration_.vehicle.max_deceleration));
  timeout_ = environment_->timeout > 0 ? environment_->timeout : timeout_laps * vehicle::profile_time(capped);
  timeout_ *= settings.rounds;
  if (!course.closed && rules.finishes_open_courses())
    open_length_ =
        course.length - environment_->track->lap_path()->project({start_.x, start_.y}).arc - finish_tolerance;
}

double LapRunner::control_period() const noexcept {
  return rules_of(environment_->protocol).control_period(configuration_);
}

std::unique_ptr<vehicle::Planner> LapRunner::make_planner() const {
  auto model = vehicle::make_vehicle_model(configuration_.vehicle);
  vehicle::PlannerOptions options = configuration_.planner;
  // A planner that estimates the car's motion must know the time between two updates. The paper's program
  // does not: its planner assumes 0.025 s where its simulator takes steps of 0.01 s.
  if (model->has_dynamics()) options.control_period = control_period();
  std::vector<maps::ReferencePoint> path = path_;
  for (maps::ReferencePoint& point : path) point.speed *= speed_share_;
  return std::make_unique<vehicle::Planner>(options, std::move(model), path,
                                            vehicle::make_solver(configuration_, method_, settings_.threads));
}

double LapRunner::lap_length() const noexcept {
  return open_length_ > 0 ? open_length_ : settings_.rounds * environment_->track->lap_path()->length();
}

double LapRunner::progress(const sim::World& world) const noexcept {
  return std::clamp(world.laps(0)->progress() / lap_length(), 0.0, 1.0);
}

bool LapRunner::at_finish(const sim::World& world) const noexcept {
  if (open_length_ > 0) return world.laps(0)->progress() >= open_length_;
  if (settings_.rounds > 1) return world.laps(0)->laps() >= settings_.rounds;
  return rules_of(environment_->protocol).lap_complete(world, progress(world));
}

LapResult LapRunner::run(std::uint64_t seed, const ControlStepCallback& on_step,
                         const std::atomic<bool>* cancel) {
  const std::unique_ptr<LapInProgress> lap = begin(seed);
  while (!at_finish(lap->world) && lap->world.time() <= timeout_) {
    if (cancel && cancel->load(std::memory_order_relaxed)) {
      lap->result.cancelled = true;
      break;
    }
    control(*lap, on_step);
    advance(*lap);
  }
  finish(*lap);
  return std::move(lap->result);
}

void LapRunner::finish(LapInProgress& lap) const {
  LapResult& result = lap.result;
  const LapRules& rules = rules_of(environment_->protocol);
  result.finished = at_finish(lap.world);
  result.timeout = !result.finished && !result.cancelled;
  result.collisions = rules.collisions(lap.log);
  result.collided_bodies = lap.log.collisions();
  result.wall = lap.log.hit_wall();
  if (lap.driver->hardware()) result.localisation = lap.driver->hardware()->record();
  if (lap.driver->tracking()) result.tracking = lap.driver->tracking()->record();
  if (lap.overtaking) result.overtaking = lap.overtaking->record(result.timeout);
  result.time = lap.world.time();
  if (result.finished && open_length_ <= 0)
    result.time = settings_.rounds > 1 ? lap.world.laps(0)->lap_start_time() : rules.lap_time(lap.world);
  if (result.steps == 0) return;
  const double n = result.steps;
  const LapInProgress::Sums& sums = lap.sums;
  result.state_cost = sums.state_cost / n;
  result.collision_cost = sums.collision_cost / n;
  result.mean_sequence_cost = result.state_cost + result.collision_cost;
  result.paper_model_cost = sums.paper_model_cost / n;
  result.driven_cost = sums.driven_cost / n;
  result.input_error = sums.input_error / n;
  result.mean_speed = sums.speed / n;
  result.mean_path_distance = sums.path_distance / n;
  if (sums.solves > 0) {
    result.mean_variance = sums.variance / sums.solves;
    result.mean_effective_samples = sums.effective_samples / sums.solves;
  }
}

}  // namespace slalom::evaluation
