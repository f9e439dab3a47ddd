#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <vector>

#include "slalom/maps/distance_field.hpp"
#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"

namespace slalom::maps {
namespace {

/// A closed path with straights and turns, about as long as an indoor race track, with a point every 4 cm.
std::vector<ReferencePoint> course() {
  std::vector<ReferencePoint> path;
  constexpr int count = 1500;
  for (int i = 0; i < count; ++i) {
    const double t = 2 * std::numbers::pi * i / count;
    const double radius = 8 + 2.5 * std::cos(3 * t);
    path.push_back({radius * std::cos(t), 0.8 * radius * std::sin(t), 0, 3 + std::cos(3 * t)});
  }
  for (int i = 0; i < count; ++i) {
    const ReferencePoint &a = path[static_cast<std::size_t>(i)],
                         &b = path[static_cast<std::size_t>((i + 1) % count)];
    path[static_cast<std::size_t>(i)].yaw = std::atan2(b.y - a.y, b.x - a.x);
  }
  return path;
}

/// A corridor 2.2 m wide with noise, seen by 1080 beams.
std::vector<float> corridor_scan() {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<float> ranges;
  for (int i = 0; i < 1080; ++i) {
    const double angle = -2.35 + i * 4.7 / 1080;
    const double side = 1.1 / std::max(1e-3, std::abs(std::sin(angle)));
    const double ahead = 7 / std::max(1e-3, std::abs(std::cos(angle)));
    ranges.push_back(static_cast<float>(std::min(side, ahead) + noise(random)));
  }
  return ranges;
}

void distance_transform_600(benchmark::State& state) {
  OccupancyGrid grid{600, 600, 0.05, {}, std::vector<Occupancy>(360000, Occupancy::occupied)};
  for (int y = 0; y < 600; ++y) {
    for (int x = 0; x < 600; ++x) {
      const double r = std::hypot(x - 300, 1.25 * (y - 300)), turn = std::atan2(1.25 * (y - 300), x - 300);
      if (std::abs(r - 160 - 50 * std::cos(3 * turn)) < 25) grid.at(x, y) = Occupancy::free;
    }
  }
  for (auto _ : state) {
    const DistanceField field = distance_transform(grid, false);
    if (!(field.at(510, 300) > 0.5)) state.SkipWithError("no distance in the middle of the corridor");
    benchmark::DoNotOptimize(field.distance.data());
  }
}
BENCHMARK(distance_transform_600)->Unit(benchmark::kMillisecond);

void distance_transform_open_2000(benchmark::State& state) {
  OccupancyGrid grid{2000, 2000, 0.05, {}, std::vector<Occupancy>(4000000, Occupancy::free)};
  for (int i = 0; i < 4000; ++i) {
    const double turn = 2 * std::numbers::pi * i / 4000;
    grid.at(1000 + static_cast<int>(800 * std::cos(turn)), 1000 + static_cast<int>(500 * std::sin(turn))) =
        Occupancy::occupied;
  }
  for (auto _ : state) {
    const DistanceField field = distance_transform(grid, false);
    if (!(field.at(1000, 1000) > 20)) state.SkipWithError("no distance in the middle");
    benchmark::DoNotOptimize(field.distance.data());
  }
}
BENCHMARK(distance_transform_open_2000)->Unit(benchmark::kMillisecond);

void cost_map(benchmark::State& state, const LocalCostMapOptions& options) {
  LocalCostMap map(options);
  const std::vector<float> ranges = corridor_scan();
  const LaserScanView scan{ranges, -2.35, 4.7 / 1080, 0, 30};
  for (auto _ : state) {
    if (map.update(scan).used < 1000) state.SkipWithError("points are missing");
    benchmark::ClobberMemory();
  }
  if (map.at(1, 1.1) != 100 || map.at(1, 0) != 0) state.SkipWithError("the corridor is not in the map");
}
BENCHMARK_CAPTURE(cost_map, exact, LocalCostMapOptions{})->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(cost_map, published, published_cost_map())->Unit(benchmark::kMicrosecond);

void reference_field(benchmark::State& state, const ReferenceFieldOptions& options, double reach) {
  const auto path = course();
  ReferenceField field(path, options);
  std::size_t i = 0;
  for (auto _ : state) {
    i = (i + 4) % path.size();
    const double aside = 0.2 * std::sin(0.1 * static_cast<double>(i));
    field.update({path[i].x + aside, path[i].y + 0.03}, reach);
    if (!(field.at(path[i].x + aside, path[i].y + 0.03).distance < 0.4))
      state.SkipWithError("wrong distance");
    benchmark::ClobberMemory();
  }
}
BENCHMARK_CAPTURE(reference_field, published_whole, published_reference_field(), INFINITY)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(reference_field, published_reach_4m, published_reference_field(), 4.0)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace slalom::maps
