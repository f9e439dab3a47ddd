#include "bench/workload/measurements.hpp"

#include <chrono>

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

/// Measures rollouts of one problem, ns per step.
class Rollouts {
 public:
  Rollouts(const ReferenceWorkload& workload, const vehicle::VehicleOptions& problem, int samples, int steps,
           simd::Target target)
      : model_(workload.model(problem, target)),
        batch_(workload.sequences(samples, steps, model_->inputs())),
        costs_(static_cast<std::size_t>(batch_.stride())),
        collided_(static_cast<std::size_t>(batch_.stride())) {}
  void run() {
    const BatchEvaluator* const evaluator = &model_->evaluator();
    const auto begin = Clock::now();
    evaluator->evaluate(batch_, 0, batch_.samples(), costs_.data(), collided_.data());
    times_.push_back(1e9 * seconds_since(begin) / (static_cast<double>(batch_.samples()) * batch_.steps()));
    if (!(costs_[0] > 0)) throw std::logic_error("the costs of the rollouts must be positive");
  }
  TimeStatistics statistics() const { return time_statistics(times_); }

 private:
  std::unique_ptr<vehicle::VehicleModel> model_;
  SequenceBatch batch_;
  AlignedBuffer costs_;
  std::vector<std::uint8_t> collided_;
  std::vector<double> times_;
};

}  // namespace

void compare_with_yardstick(const ReferenceWorkload& workload, simd::Target target) {
  constexpr int samples = 2000;
  const SequenceBatch batch = workload.sequences(samples);
  const auto model = workload.model(reference_problem(), target);
  std::vector<double> expected(samples);
  workload.yardstick().evaluate(workload.start(), batch, samples, expected.data());
  AlignedBuffer costs(static_cast<std::size_t>(batch.stride()));
  std::vector<std::uint8_t> collided(costs.size());
  model->evaluator().evaluate(batch, 0, samples, costs.data(), collided.data());
  int different = 0;
  for (std::size_t k = 0; k < samples; ++k)
    different += std::abs(static_cast<double>(costs[k]) - expected[k]) > 1e-3 * std::max(1.0, expected[k]);
  if (different > samples / 500) throw std::logic_error("the costs of rollouts and yardstick differ");
}

RolloutSpeed measure_rollouts(const ReferenceWorkload& workload,
                              std::span<const vehicle::VehicleOptions> problems, int samples, int steps,
                              simd::Target target, double seconds) {
  Stick stick(workload);
  std::vector<Rollouts> all;
  for (const vehicle::VehicleOptions& problem : problems)
    all.emplace_back(workload, problem, samples, steps, target);
  repeat(seconds, [&] {
    stick.run();
    for (Rollouts& each : all) each.run();
  });
  RolloutSpeed speed{stick.statistics(), {}};
  for (const Rollouts& each : all) speed.rollouts.push_back(each.statistics());
  return speed;
}

SolveSpeed measure_solve(const ReferenceWorkload& workload, const vehicle::VehicleOptions& problem,
                         const SolverOptions& options, double seconds) {
  const auto model = workload.model(problem, simd::active_target());
  const BatchEvaluator* const evaluator = &model->evaluator();
  const auto solver = make_solver(options, model->inputs());
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

DrivenPlanner::DrivenPlanner(const vehicle::Configuration& configuration)
    : planner_([&] {
        auto model = vehicle::make_vehicle_model(configuration.vehicle);
        estimates_ = model->traits().tyres.friction > 0;
        return vehicle::Planner(configuration.planner, std::move(model), course_,
                                make_solver(configuration, "svg_mppi", 1));
      }()) {
  const int places = estimates_ ? 48 : 16;
  for (int i = 0; i < places; ++i) {
    const maps::ReferencePoint& p = course_[static_cast<std::size_t>(2 * i)];
    poses_.push_back({p.x + 0.05 * std::sin(estimates_ ? 0.1 * i : i), p.y, p.yaw});
    scans_.push_back(reference_scan(poses_.back()));
  }
}

const vehicle::PlannerOutput& DrivenPlanner::update() {
  if (estimates_ && at_ == 0) planner_.reset(1);
  const std::size_t at = at_;
  at_ = (at_ + 1) % scans_.size();
  return planner_.update({scans_[at].view(), {poses_[at], 4.0}, {}});
}

TickSpeed measure_tick(const vehicle::Configuration& configuration, double seconds) {
  DrivenPlanner planner(configuration);
  std::vector<double> whole, rest;
  repeat(seconds, [&] {
    const vehicle::PlannerOutput& out = planner.update();
    if (!out.solve) throw std::logic_error("the planner of the workload returned no plan");
    whole.push_back(1e3 * out.tick_time);
    rest.push_back(1e3 * (out.tick_time - out.solve->times.total));
  });
  return {time_statistics(whole), time_statistics(rest)};
}

}  // namespace slalom::workload
