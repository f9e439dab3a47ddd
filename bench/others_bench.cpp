#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bench/workload/reference_workload.hpp"
#include "slalom/evaluation/statistics.hpp"
#include "slalom/tracking/predictor.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

/// An update of the planner of the configuration `default` among other cars, all of them near, with four
/// hypotheses each. `solve_p50` and `solve_p99` are the CPU time of its solves alone, ms, which other
/// processes do not add to.
namespace slalom::workload {
namespace {

/// Cars round the car at `place` of the course, ahead, beside and behind.
std::vector<tracking::TrackedObject> cars_near(const std::vector<maps::ReferencePoint>& course,
                                               std::size_t place, int cars) {
  std::vector<tracking::TrackedObject> objects;
  for (int i = 0; i < cars; ++i) {
    const std::size_t ahead = place + 10 + 12 * static_cast<std::size_t>(i / 2);  // points of 0.05 m
    const maps::ReferencePoint& at = course[ahead % course.size()];
    const double offset = i % 2 == 0 ? 0.45 : -0.35;
    tracking::TrackedObject object;
    object.id = i + 1;
    object.pose = {at.x - offset * std::sin(at.yaw), at.y + offset * std::cos(at.yaw), at.yaw};
    object.speed = 2.5;
    object.length = 0.58;
    object.width = 0.31;
    for (int k = 0; k < 3; ++k) object.covariance[k][k] = 1e-3;
    object.covariance[3][3] = 0.04;
    objects.push_back(object);
  }
  return objects;
}

/// A solver that notes the CPU time of its solves.
class TimedSolver final : public Solver {
 public:
  TimedSolver(std::unique_ptr<Solver> timed, std::vector<double>& times)
      : timed_(std::move(timed)), times_(times) {}

  const char* name() const noexcept override { return timed_->name(); }
  int horizon() const noexcept override { return timed_->horizon(); }
  int inputs() const noexcept override { return timed_->inputs(); }
  bool keeps_bounds() const noexcept override { return timed_->keeps_bounds(); }
  bool takes_proposals() const noexcept override { return timed_->takes_proposals(); }
  std::unique_ptr<Solver> clone() const override {
    return std::make_unique<TimedSolver>(timed_->clone(), times_);
  }
  const SolveResult& result() const noexcept override { return timed_->result(); }
  const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept override {
    const double begin = cpu_time();
    const SolveResult& result = timed_->solve(evaluator, request);
    times_.push_back(cpu_time() - begin);
    return result;
  }
  void reset(std::uint64_t seed) noexcept override { timed_->reset(seed); }
  void prepare() noexcept override { timed_->prepare(); }
  void connect(const BatchEvaluator& evaluator) override { timed_->connect(evaluator); }

 private:
  /// ms, of this thread.
  static double cpu_time() noexcept {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  }

  std::unique_ptr<Solver> timed_;
  std::vector<double>& times_;
};

void update(benchmark::State& state) {
  const auto course = reference_course();
  const auto configuration = vehicle::load_configuration(SLALOM_CONFIGS "/default.yaml");
  std::vector<double> solves;
  solves.reserve(1 << 20);
  vehicle::Planner planner(configuration.planner, vehicle::make_vehicle_model(configuration.vehicle), course,
                           std::make_unique<TimedSolver>(make_solver(configuration, "svg_mppi", 1), solves));
  tracking::Predictor predictor(course);
  const auto objects = cars_near(course, 0, static_cast<int>(state.range(0)));
  const auto others = predictor.update(objects, 0);
  for (const maps::PredictedObstacle& each : others)
    if (each.hypotheses != 4) state.SkipWithError("a car has not four hypotheses");
  const maps::Pose pose{course[0].x, course[0].y, course[0].yaw};
  const ReferenceScan scan = reference_scan(pose);
  for (auto _ : state) {
    const auto& out = planner.update({.scan = scan.view(), .odometry = {pose, 4.0}, .others = others});
    if (!out.solve) state.SkipWithError("no plan");
  }
  state.counters["solve_p50"] = evaluation::percentile(solves, 0.5);
  state.counters["solve_p99"] = evaluation::percentile(solves, 0.99);
}
BENCHMARK(update)->ArgName("cars")->Arg(0)->Arg(1)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);

void prediction(benchmark::State& state) {
  const auto course = reference_course();
  tracking::Predictor predictor(course);
  const auto objects = cars_near(course, 0, static_cast<int>(state.range(0)));
  double stamp = 0;
  for (auto _ : state) benchmark::DoNotOptimize(predictor.update(objects, stamp += 0.025).data());
}
BENCHMARK(prediction)->ArgName("cars")->Arg(1)->Arg(4)->Arg(8)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace slalom::workload
