// An update of the tracker of other cars: 1081 beams on a ring road, as many cars as the argument says.
#include <benchmark/benchmark.h>

#include <vector>

#include "slalom/tracking/object_tracker.hpp"
#include "tracking/scene.hpp"

namespace slalom::tracking {
namespace {

using test::Scene;

/// Ten seconds of driving, again and again; every update has its scan computed beforehand.
void update(benchmark::State& state, bool with_map) {
  Scene scene;
  struct Seen {
    std::vector<float> ranges;
    TrackerInput input;
  };
  std::vector<Seen> seen;
  for (int k = 0; k < 400; ++k) {
    const double time = k * Scene::period;
    const maps::Pose sensor = Scene::on_ring(0.55 * time);
    std::vector<sim::Box> cars;
    for (int i = 0; i < state.range(0); ++i)
      cars.push_back(Scene::car(Scene::on_ring(0.3 + 0.25 * (i / 2) + 0.5 * time, i % 2 ? 5.0 : 6.1)));
    const maps::LaserScanView scan = scene.scan(sensor, cars);
    seen.push_back({{scan.ranges.begin(), scan.ranges.end()}, {scan, sensor, time, 0.03, 0.01}});
  }
  for (Seen& each : seen) each.input.scan.ranges = each.ranges;
  ObjectTracker tracker = with_map ? ObjectTracker(scene.map()) : ObjectTracker();
  std::size_t i = 0, objects = 0;
  for (auto _ : state) {
    if (i == 0) tracker.reset();
    objects += tracker.update(seen[i].input).objects.size();
    i = (i + 1) % seen.size();
  }
  state.counters["objects"] = static_cast<double>(objects) / static_cast<double>(state.iterations());
}

BENCHMARK_CAPTURE(update, with_map, true)->Arg(0)->Arg(2)->Arg(8)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(update, without_map, false)->Arg(0)->Arg(2)->Arg(8)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace slalom::tracking
