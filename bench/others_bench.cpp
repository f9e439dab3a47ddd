#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "bench/workload/reference_workload.hpp"
#include "slalom/tracking/predictor.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"

/// An update of the planner of the configuration `default` among other cars, all of them near, with four
/// hypotheses each.
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

void update(benchmark::State& state) {
  const auto course = reference_course();
  const auto configuration = vehicle::load_configuration(SLALOM_CONFIGS "/default.yaml");
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
    if (!out.solve) state.SkipWithError("no plan");
  }
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
