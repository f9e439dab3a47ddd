#include "bench/workload/measurements.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "slalom/core/dispatch.hpp"
#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::workload {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Runs `once` for the time given, at least 30 times.
template <class Once>
void repeat(double seconds, Once&& once) {
  const auto begin = Clock::now();
  for (int i = 0; i < 30 || seconds_since(begin) < seconds; ++i) once();
}

/// Measures the yardstick on 200 rollouts at a time, ns per step.
class Stick {
 public:
  explicit Stick(const ReferenceWorkload& workload)
      : start_(workload.start()),
        yardstick_(workload.yardstick()),
        batch_(workload.sequences(count)),
        costs_(count) {}
  void run() {
    const auto begin = Clock::now();
    yardstick_.evaluate(start_, batch_, count, costs_.data());
    times_.push_back(1e9 * seconds_since(begin) / (count * ReferenceWorkload::steps));
    if (!(costs_.front() > 0)) throw std::logic_error("the costs of the yardstick must be positive");
  }
  TimeStatistics statistics() const { return time_statistics(times_); }

 private:
  static constexpr int count = 200;
  CarStart start_;
  Yardstick yardstick_;
  SequenceBatch batch_;
  std::vector<double> costs_, times_;
};

}  // namespace

RolloutSpeed measure_rollouts(const ReferenceWorkload& workload, const vehicle::VehicleOptions& problem,
                              int samples, int steps, simd::Target target, double seconds) {
  const auto model = workload.model(problem, target);
  const BatchEvaluator* const evaluator = &model->evaluator();
  const SequenceBatch batch = workload.sequences(samples, steps);
  AlignedBuffer costs(static_cast<std::size_t>(batch.stride()));
  std::vector<std::uint8_t> collided(costs.size());
  Stick stick(workload);
  std::vector<double> times;
  repeat(seconds, [&] {
    stick.run();
    for (int i = 0; i < 4; ++i) {
      const auto begin = Clock::now();
      evaluator->evaluate(batch, 0, samples, costs.data(), collided.data());
      times.push_back(1e9 * seconds_since(begin) / (static_cast<double>(samples) * steps));
    }
  });
  if (!(costs[0] > 0)) throw std::logic_error("the costs of the rollouts must be positive");
  return {stick.statistics(), time_statistics(times)};
}

SolveSpeed measure_solve(const ReferenceWorkload& workload, const vehicle::VehicleOptions& problem,
                         const SolverOptions& options, double seconds) {
  const auto model = workload.model(problem, simd::active_target());
  const BatchEvaluator* const evaluator = &model->evaluator();
  const auto solver = make_solver(options, 1);
  Stick stick(workload);
  std::vector<double> fresh, prepared, draw, evaluate, guide, update;
  int turn = 0, solves = 0, degenerate = 0;
  repeat(seconds, [&] {
    if (turn % 8 == 0) stick.run();
    const bool ahead = turn++ % 2 == 1;
    if (ahead) solver->prepare();
    const auto begin = Clock::now();
    const SolveResult& result = solver->solve(*evaluator, {.elapsed = 0.025});
    (ahead ? prepared : fresh).push_back(1e3 * seconds_since(begin));
    degenerate += result.status == Status::degenerate;
    ++solves;
    if (ahead) return;
    draw.push_back(result.times.draw);
    evaluate.push_back(result.times.evaluate);
    guide.push_back(result.times.guide);
    update.push_back(result.times.update);
  });
  SolveSpeed speed{
      solver_name(options), time_statistics(fresh), time_statistics(prepared), stick.statistics(), {}, 0};
  speed.degenerate_share = static_cast<double>(degenerate) / solves;
  speed.stages.draw = time_statistics(draw).p50;
  speed.stages.evaluate = time_statistics(evaluate).p50;
  speed.stages.guide = time_statistics(guide).p50;
  speed.stages.update = time_statistics(update).p50;
  speed.stages.total = speed.solve.p50 * 1e-3;
  return speed;
}

TickSpeed measure_tick(const vehicle::Configuration& configuration, double seconds) {
  const auto course = reference_course();
  vehicle::Planner planner(configuration.planner, vehicle::make_vehicle_model(configuration.vehicle), course,
                           make_solver(configuration, "svg_mppi", 1));
  constexpr int places = 16;
  std::vector<maps::Pose> poses;
  std::vector<ReferenceScan> scans;
  for (int i = 0; i < places; ++i) {
    const maps::ReferencePoint& p = course[static_cast<std::size_t>(2 * i)];
    poses.push_back({p.x + 0.05 * std::sin(i), p.y, p.yaw});
    scans.push_back(reference_scan(poses.back()));
  }
  std::vector<double> whole, rest;
  std::size_t at = 0;
  repeat(seconds, [&] {
    const vehicle::PlannerOutput& out = planner.update({scans[at].view(), {poses[at], 4.0}, {}});
    if (!out.solve) throw std::logic_error("the planner of the workload returned no plan");
    whole.push_back(1e3 * out.tick_time);
    rest.push_back(1e3 * (out.tick_time - out.solve->times.total));
    at = (at + 1) % places;
  });
  return {time_statistics(whole), time_statistics(rest)};
}

}  // namespace slalom::workload
