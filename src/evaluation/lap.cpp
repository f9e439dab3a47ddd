// A lap while it is driven: the loop of its cars, and the meters of the first one.
#include "slalom/evaluation/lap.hpp"

#include "evaluation/driver/car_driver.hpp"
#include "evaluation/lap_setup.hpp"
#include "evaluation/overtaking/overtaking_meter.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::evaluation {
namespace {

/// Returns the sum of |u| over the first input (the steering) of every step, rad.
double sum_of_steering(const vehicle::PlannerOutput& output) {
  double sum = 0;
  for (std::size_t row = 0; row < output.inputs.size();
       row += static_cast<std::size_t>(output.inputs_per_step))
    sum += std::abs(static_cast<double>(output.inputs[row]));
  return sum;
}

/// Mean over the steps of the variance of the first input, rad^2.
double mean_variance(const SolveResult& solve, std::size_t inputs) {
  if (solve.variances.empty()) return 0;
  const std::size_t steps = solve.variances.size() / inputs;
  double sum = 0;
  for (std::size_t k = 0; k < steps; ++k) sum += static_cast<double>(solve.variances[k * inputs]);
  return sum / static_cast<double>(steps);
}

/// Compares the planner's observers with the truth.
void record_estimate(EstimationRecord& record, const vehicle::PlannerOutput& output,
                     const sim::Observation& seen) {
  if (output.parameters.friction == 0) return;
  record.yaw_rate_error.push_back(static_cast<float>(std::abs(output.yaw_rate_estimate - seen.yaw_rate)));
  record.slip_error.push_back(static_cast<float>(std::abs(output.slip_estimate - seen.slip)));
  record.speed_error.push_back(static_cast<float>(std::abs(output.speed_estimate - seen.speed)));
  record.last = output.parameters;
  if (record.informed_time < 0 && output.parameters.confidence >= 0.5) record.informed_time = seen.time;
}

}  // namespace

struct LapDrive::State {
  State(const LapSetup& lap, std::uint64_t lap_seed)
      : setup((check_settings(lap), lap)),
        rules(&rules_of(lap.environment->protocol)),
        seed(lap_seed),
        drive(start_lap(lap, lap_seed, result.obstacles)),
        meter(path_of(lap), lap.driver.configuration.vehicle),
        length(lap.length()),
        timeout(lap.timeout()) {
    result.seed = lap_seed;
    result.min_clearance = std::numeric_limits<double>::infinity();
    const sim::World& world = drive.world;
    if (world.cars() > 1) overtaking.emplace(world);
  }

  double progress() const noexcept { return std::clamp(drive.world.laps(0)->progress() / length, 0.0, 1.0); }
  bool at_finish() const noexcept {
    if (ends_with_path(setup)) {
      const double driven = drive.world.laps(0)->progress(), stands = 0.2;  // m, m/s
      return driven >= length + 2 * finish_tolerance ||
             (driven >= length && std::abs(drive.world.observe(0).speed) < stands);
    }
    if (setup.settings.rounds > 1) return drive.world.laps(0)->laps() >= setup.settings.rounds;
    return rules->lap_complete(drive.world, progress());
  }

  void step(const ControlStepCallback& on_step, double extra_latency, bool past_finish);
  void measure(const PlannerUpdate& update, const ControlStepCallback& on_step);
  void record_collisions();
  void record_clearance();
  void conclude();

  LapResult result;
  LapSetup setup;
  const LapRules* rules;
  std::uint64_t seed;
  CarDrive drive;
  SequenceCostMeter meter;
  std::optional<OvertakingMeter> overtaking;  ///< meter of encounters with opponents
  sim::CollisionLog log;
  LapFigures sums;  ///< sums over control steps or solves; the result has their means
  int solves = 0;
  double length, timeout;  ///< m, s
};

/// Drives one control period. It ends early at the finish unless `past_finish` is true.
void LapDrive::State::step(const ControlStepCallback& on_step, double extra_latency, bool past_finish) {
  Observer observer{[&](std::size_t car, const PlannerUpdate& update) {
                      if (car == 0) measure(update, on_step);
                    },
                    [&](const sim::World& world) {
                      if (overtaking) overtaking->update(world);
                      record_collisions();
                      return past_finish || !at_finish();
                    }};
  drive.drivers[0].planning().set_extra_latency(extra_latency);
  drive.step(observer);
  record_clearance();
}

/// Adds an update of the first car's planner to the figures of the lap.
void LapDrive::State::measure(const PlannerUpdate& update, const ControlStepCallback& on_step) {
  const sim::Observation& seen = update.seen;
  const vehicle::PlannerOutput& output = *update.output;
  const vehicle::Planner& planner = drive.drivers[0].planning().planner();
  if (update.localised) record_estimate(result.estimation, output, seen);

  // With the published maps, the meter uses the planner's cost map instead of computing it again.
  meter.observe(update.scan, update.odometry.pose,
                setup.driver.configuration.planner.published.maps ? &planner.cost_map() : nullptr);
  const SequenceCostMeter::Cost cost = meter.planned(output);
  sums.state_cost += cost.state;
  sums.collision_cost += cost.collision;
  sums.input_error += sum_of_steering(output);
  sums.mean_speed += seen.speed;
  const double path_distance = meter.path_distance();
  sums.mean_path_distance += path_distance;
  result.max_path_distance = std::max(result.max_path_distance, path_distance);
  result.corrections += output.corrections;
  ++result.planner_status[static_cast<std::size_t>(output.status)];
  result.tick_ms.push_back(static_cast<float>(1e3 * output.tick_time));
  if (output.solve) {
    const SolveResult& solve = *output.solve;
    ++solves;
    sums.mean_effective_samples += solve.effective_sample_size;
    sums.mean_variance += mean_variance(solve, static_cast<std::size_t>(output.inputs_per_step));
    result.solve_ms.push_back(static_cast<float>(1e3 * solve.times.total));
  }
  if (on_step)
    on_step({result.steps, seen.time, progress(), rules->collisions(log), seen, update.scan, update.odometry,
             output, planner, drive.world, cost, update.others});
  ++result.steps;
}

void LapDrive::State::record_collisions() {
  const sim::Observation seen = drive.world.observe(0);
  if (!seen.collides()) return;
  auto& first = result.first_collisions;
  const auto record = [&](int body) {
    const auto same = [&](const Collision& c) { return c.body == body; };
    if (std::none_of(first.begin(), first.end(), same)) first.push_back({seen.time, seen.pose, body});
  };
  if (seen.wall) record(-1);
  for (const int body : seen.colliding) record(body);
  log.update(drive.world, 0);
}

void LapDrive::State::record_clearance() {
  const sim::World& world = drive.world;
  const sim::Box car = world.outline(0);
  for (const maps::Point& corner : sim::corners(car))
    result.min_clearance = std::min(result.min_clearance, world.track().distance_to_wall(corner));
  for (std::size_t i = 1; i < world.bodies(); ++i)
    result.min_clearance = std::min(result.min_clearance, sim::signed_gap(car, world.outline(i)));
}

/// Completes the result of a lap that has ended.
void LapDrive::State::conclude() {
  const sim::World& world = drive.world;
  const PlanningDriver& driver = drive.drivers[0].planning();
  result.finished = at_finish();
  result.timeout = !result.finished && !result.cancelled;
  result.collisions = rules->collisions(log);
  result.collided_bodies = log.collisions();
  result.success = result.finished && result.collisions == 0;
  result.hit_wall = log.hit_wall();
  if (driver.hardware()) result.localisation = driver.hardware()->record();
  if (driver.tracking()) result.tracking = driver.tracking()->record();
  if (overtaking) result.overtaking = overtaking->record(result.timeout);
  result.time = world.time();
  if (result.finished && !ends_with_path(setup))
    result.time = setup.settings.rounds > 1 ? world.laps(0)->lap_start_time() : rules->lap_time(world);
  const auto mean = [&](double LapFigures::*figure, int count) {
    if (count > 0) result.*figure = sums.*figure / count;
  };
  for (const auto figure : {&LapFigures::state_cost, &LapFigures::collision_cost, &LapFigures::input_error,
                            &LapFigures::mean_speed, &LapFigures::mean_path_distance})
    mean(figure, result.steps);
  mean(&LapFigures::mean_variance, solves);
  mean(&LapFigures::mean_effective_samples, solves);
}

LapDrive::LapDrive(const LapSetup& setup, std::uint64_t seed)
    : state_(std::make_unique<State>(setup, seed)) {}
LapDrive::~LapDrive() = default;
LapDrive::LapDrive(const LapDrive& other) : state_(std::make_unique<State>(*other.state_)) {}
LapDrive& LapDrive::operator=(const LapDrive& other) {
  return *this = LapDrive(other);
}
LapDrive::LapDrive(LapDrive&&) noexcept = default;
LapDrive& LapDrive::operator=(LapDrive&&) noexcept = default;

void LapDrive::step(const ControlStepCallback& on_step, double extra_latency) {
  state_->step(on_step, extra_latency, true);
}

LapResult LapDrive::finish(const ControlStepCallback& on_step, const std::atomic<bool>* cancel) {
  State& lap = *state_;
  lap.result.cancelled = false;
  while (!lap.at_finish() && lap.drive.world.time() <= lap.timeout) {
    if (cancel && cancel->load(std::memory_order_relaxed)) {
      lap.result.cancelled = true;
      break;
    }
    lap.step(on_step, 0, false);
  }
  lap.conclude();
  return lap.result;
}

void LapDrive::change_driver(const Driver& driver) {
  LapSetup changed = state_->setup;
  changed.driver = driver;
  if (changed.control_period() != state_->setup.control_period())
    throw std::invalid_argument("planner.control_period: must be that of the present driver");
  vehicle::Planner planner = make_planner(changed);
  SequenceCostMeter meter(path_of(changed), driver.configuration.vehicle);
  planner.reset(solver_seed(state_->seed, driver.method));
  state_->drive.drivers[0].planning().change(std::move(planner));
  state_->meter = std::move(meter);
  state_->setup = std::move(changed);
}

const LapSetup& LapDrive::setup() const noexcept {
  return state_->setup;
}
int LapDrive::steps() const noexcept {
  return state_->result.steps;
}
sim::World& LapDrive::world() noexcept {
  return state_->drive.world;
}
const sim::World& LapDrive::world() const noexcept {
  return state_->drive.world;
}
int LapDrive::collisions() const noexcept {
  return state_->rules->collisions(state_->log);
}
std::span<const Collision> LapDrive::first_collisions() const noexcept {
  return state_->result.first_collisions;
}

LapResult run_lap(const LapSetup& setup, std::uint64_t seed, const ControlStepCallback& on_step,
                  const std::atomic<bool>* cancel) {
  return LapDrive(setup, seed).finish(on_step, cancel);
}

}  // namespace slalom::evaluation
