// One control step of a lap: the planner's update, then the world until the next one.
#include <algorithm>
#include <cmath>

#include "evaluation/lap_in_progress.hpp"
#include "evaluation/lap_rules.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::evaluation {
namespace {

/// sum of |u| over the first input (the steering) of every step, rad
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

void LapRunner::control(LapInProgress& lap, const ControlStepCallback& on_step, double extra_latency) const {
  const DriverStack::Update update = lap.driver->update(lap.world);
  const sim::Observation& seen = update.seen;
  const vehicle::PlannerOutput& output = update.output;
  const vehicle::Planner& planner = lap.driver->planner();
  if (update.localised) record_estimate(lap.result.estimation, output, seen);

  // If the planner's cost map has the options of the meter's, it is not computed twice.
  lap.meter.observe(update.scan, update.odometry.pose,
                    configuration_.planner.published.maps ? &planner.cost_map() : nullptr);
  const SequenceCostMeter::Cost cost = lap.meter.planned(output);
  lap.sums.state_cost += cost.state;
  lap.sums.collision_cost += cost.collision;
  if (settings_.additional_costs) {
    lap.sums.paper_model_cost += lap.meter.paper_model(output).total();
    lap.sums.driven_cost += lap.meter.present().total();
  }
  lap.sums.input_error += sum_of_steering(output);
  lap.sums.speed += seen.speed;
  const double path_distance = lap.meter.path_distance();
  lap.sums.path_distance += path_distance;
  LapResult& result = lap.result;
  result.max_path_distance = std::max(result.max_path_distance, path_distance);
  result.corrections += output.corrections;
  ++result.planner_status[static_cast<std::size_t>(output.status)];
  result.tick_ms.push_back(static_cast<float>(1e3 * output.tick_time));
  if (output.solve) {
    const SolveResult& solve = *output.solve;
    ++lap.sums.solves;
    lap.sums.effective_samples += solve.effective_sample_size;
    lap.sums.variance += mean_variance(solve, static_cast<std::size_t>(output.inputs_per_step));
    result.solve_ms.push_back(static_cast<float>(1e3 * solve.times.total));
  }
  if (on_step)
    on_step({result.steps, seen.time, progress(lap.world),
             rules_of(environment_->protocol).collisions(lap.log), seen, update.scan, update.odometry, output,
             planner, lap.world, cost, update.others});
  ++result.steps;
  lap.driver->send(output.command, lap.world, extra_latency);
}

void LapRunner::advance(LapInProgress& lap, bool past_finish) const {
  const auto steps = DriverStack::steps_per_command(*this, lap.world);
  for (long long k = 0; k < steps && (past_finish || !at_finish(lap.world)); ++k) {
    lap.commands[0] = lap.driver->command(lap.world);
    command_opponents(lap, k == 0);
    lap.world.step(lap.commands);
    lap.driver->moved(lap.world);
    for (auto& opponent : lap.opponents)
      if (auto* driver = std::get_if<DriverStack>(&opponent)) driver->moved(lap.world);
    if (lap.overtaking) lap.overtaking->update(lap.world);
    record_collisions(lap);
  }
  LapResult& result = lap.result;
  const sim::Box body = lap.world.outline(0);
  for (const maps::Point& corner : sim::corners(body))
    result.min_clearance = std::min(result.min_clearance, environment_->track->distance_to_wall(corner));
  for (std::size_t i = 1; i < lap.world.bodies(); ++i)
    result.min_clearance = std::min(result.min_clearance, sim::signed_gap(body, lap.world.outline(i)));
}

/// Sets the commands of all opponents. Those that look or plan decide once in every control period.
void LapRunner::command_opponents(LapInProgress& lap, bool decide) const {
  for (std::size_t i = 0; i < lap.opponents.size(); ++i) {
    auto& opponent = lap.opponents[i];
    Command& command = lap.commands[i + 1];
    if (const auto* pursuit = std::get_if<sim::PurePursuit>(&opponent)) {
      const sim::CarState& car = lap.world.state(i + 1);
      command = pursuit->command({car.x, car.y, car.yaw});
    } else if (auto* racer = std::get_if<sim::RacingOpponent>(&opponent)) {
      if (decide) command = racer->command(lap.world);
    } else {
      auto& driver = std::get<DriverStack>(opponent);
      if (decide) driver.send(driver.update(lap.world).output.command, lap.world);
      command = driver.command(lap.world);
    }
  }
}

void LapRunner::record_collisions(LapInProgress& lap) const {
  const sim::Observation seen = lap.world.observe(0);
  if (!seen.collides()) return;
  auto& first = lap.result.first_collisions;
  const auto record = [&](int body) {
    const auto same = [&](const Collision& c) { return c.body == body; };
    if (std::none_of(first.begin(), first.end(), same)) first.push_back({seen.time, seen.pose, body});
  };
  if (seen.wall) record(-1);
  for (const int body : seen.colliding) record(body);
  lap.log.update(lap.world, 0);
}

}  // namespace slalom::evaluation
