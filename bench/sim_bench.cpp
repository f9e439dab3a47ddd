#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <vector>

#include "sim/lidar/scan.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim {
namespace {

constexpr double pi = std::numbers::pi;

/// A closed course 2.2 m wide on a map of 30 x 30 m at 0.05 m, like an indoor race track.
struct Course {
  std::vector<maps::Point> path;
  std::shared_ptr<const Track> track;

  Course() {
    constexpr int count = 600;
    for (int i = 0; i < count; ++i) {
      const double t = 2 * pi * i / count, radius = 10 + 2.5 * std::cos(3 * t);
      path.push_back({15 + radius * std::cos(t), 15 + 0.8 * radius * std::sin(t)});
    }
    maps::OccupancyGrid grid{
        600, 600, 0.05, {}, std::vector<maps::Occupancy>(360000, maps::Occupancy::occupied)};
    for (const maps::Point& p : path)
      for (int y = -22; y <= 22; ++y)
        for (int x = -22; x <= 22; ++x)
          if (x * x + y * y <= 22 * 22)
            grid.at(static_cast<int>(p.x / 0.05) + x, static_cast<int>(p.y / 0.05) + y) =
                maps::Occupancy::free;
    track = std::make_shared<const Track>(grid, LapPath(path));
  }

  maps::Pose pose(std::size_t row) const {
    const maps::Point &a = path[row % path.size()], &b = path[(row + 1) % path.size()];
    return {a.x, a.y, std::atan2(b.y - a.y, b.x - a.x)};
  }
};

const Course& course() {
  static const Course made;
  return made;
}

/// Recorded commands that drive `cars` cars along the course, so that the driver is not measured.
struct Drive {
  WorldOptions options;
  std::vector<maps::Pose> starts, parked;
  std::vector<std::vector<Command>> commands;

  Drive(int cars, int parked_cars, bool all_scan) {
    // Collisions are counted and have no effect, so that every car continues.
    options.body_response = CollisionResponse::count_only;
    for (int i = 0; i < cars; ++i) starts.push_back(course().pose(static_cast<std::size_t>(40 * i)));
    for (int i = 0; i < parked_cars; ++i) {
      const maps::Pose pose = course().pose(static_cast<std::size_t>(150 + 80 * i));
      (all_scan ? starts : parked).push_back(pose);
    }
    std::vector<PathPoint> path;
    for (const maps::Point& p : course().path) path.push_back({p, 3});
    const PurePursuit driver(path);
    World world(options, course().track);
    world.reset(1, starts, parked);
    for (int k = 0; k < 2000; ++k) {
      std::vector<Command> now(starts.size());
      for (int i = 0; i < cars; ++i)
        now[static_cast<std::size_t>(i)] = driver.command(world.observe(static_cast<std::size_t>(i)).pose);
      world.step(now);
      commands.push_back(std::move(now));
    }
  }
};

/// Steps per second, noise on: `cars` driven, `parked` in their way; with `all_scan` the parked ones scan
/// too.
void world_steps(benchmark::State& state, int cars, int parked, bool all_scan) {
  const Drive drive(cars, parked, all_scan);
  World world(drive.options, course().track);
  world.reset(1, drive.starts, drive.parked);
  std::size_t k = 0;
  double driven = 0;
  for (auto _ : state) {
    if (k == drive.commands.size()) {
      driven += world.laps(0)->progress();
      state.PauseTiming();
      world.reset(1, drive.starts, drive.parked);
      k = 0;
      state.ResumeTiming();
    }
    world.step(drive.commands[k++]);
    benchmark::DoNotOptimize(world.observe(0).scan.ranges.data());
  }
  driven += world.laps(0)->progress();
  if (!(driven > 0)) state.SkipWithError("the first car has not moved");
  state.counters["steps/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(world_steps, cars_1, 1, 0, false);
BENCHMARK_CAPTURE(world_steps, cars_2, 2, 0, false);
BENCHMARK_CAPTURE(world_steps, cars_7_of_which_5_parked, 2, 5, false);
BENCHMARK_CAPTURE(world_steps, cars_7_all_scanning, 2, 5, true);

/// One scan of 1080 beams without noise, from positions along the course.
void scan_1080(benchmark::State& state) {
  const Lidar lidar(LidarOptions{});
  std::vector<float> ranges(lidar.padded_beams());
  std::size_t row = 0;
  double sum = 0;
  for (auto _ : state) {
    lidar.scan(*course().track, course().pose(row += 7), ranges);
    sum += static_cast<double>(ranges[540]);
  }
  if (!(sum > 0)) state.SkipWithError("nothing was seen");
  state.SetLabel(simd::name(simd::active_target()));
}
BENCHMARK(scan_1080);

void scan_1080_gym(benchmark::State& state) {
  const Lidar lidar(WorldOptions::gym_compatible().lidar);
  std::vector<double> ranges(1080);
  std::size_t row = 0;
  double sum = 0;
  for (auto _ : state) {
    lidar.gym_scan(*course().track, course().pose(row += 7), ranges);
    sum += ranges[540];
  }
  if (!(sum > 0)) state.SkipWithError("nothing was seen");
}
BENCHMARK(scan_1080_gym);

void noise_1080(benchmark::State& state) {
  NormalNoise noise;
  noise.reset(1, 0);
  std::vector<float> ranges(1088, 5.0f);
  for (auto _ : state) noise.add(ranges, 1080, 1e-6, 30, 0);
  if (!(std::abs(ranges[0] - 5) < 1)) state.SkipWithError("noise is too large");
}
BENCHMARK(noise_1080);

void plant_step(benchmark::State& state) {
  Plant plant(CarParameters{}, PlantOptions{}, 0.01);
  plant.reset({.speed = 3});
  for (auto _ : state) plant.step({0.1, 3});
  if (!(plant.state().speed > 2)) state.SkipWithError("the car has stopped");
}
BENCHMARK(plant_step);

}  // namespace
}  // namespace slalom::sim
