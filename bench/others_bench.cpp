#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "bench/workload/reference_workload.hpp"
#include "bench/workload/statistics.hpp"
#include "slalom/tracking/predictor.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

/// An update of the planner of the configuration `default` among other cars, all of them near, with four
/// hypotheses each. `solve_p50` and `solve_p99` are the wall-clock times of its solves alone, ms.
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

void planner_among_cars(benchmark::State& state) {
  const auto course = reference_course();
  const auto configuration = vehicle::load_configuration(SLALOM_CONFIGS "/default.yaml");
  std::vector<double> solves;
  solves.reserve(1 << 20);
  vehicle::Planner planner(configuration.planner, vehicle::make_vehicle_model(configuration.vehicle), course,
                           make_solver(configuration, "svg_mppi", 1));
  tracking::Predictor predictor(course);
  const auto objects = cars_near(course, 0, static_cast<int>(state.range(0)));
  const auto others = predictor.update(objects, 0);
  for (const maps::PredictedObstacle& each : others)
    if (each.hypotheses != 4) state.SkipWithError("a car has not four hypotheses");
  const maps::Pose pose{course[0].x, course[0].y, course[0].yaw};
  const ReferenceScan scan = reference_scan(pose);
  for (auto _ : state) {
    const auto& out = planner.update({.scan = scan.view(), .odometry = {pose, 4.0}, .others = others});
    if (!out.solve) return state.SkipWithError("no plan");
    solves.push_back(1e3 * out.solve->times.total);
  }
  const TimeStatistics times = time_statistics(solves);
  state.counters["solve_p50"] = times.p50;
  state.counters["solve_p99"] = times.p99;
}
BENCHMARK(planner_among_cars)->ArgName("cars")->Arg(0)->Arg(1)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slalom::workload
