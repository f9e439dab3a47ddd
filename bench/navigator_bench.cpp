// Processor times of a navigator, which has one thread: an update with mppi, whose rollouts are 2000 samples
// of 56 steps with all terms of the cost, and with svg_mppi; an update of the costmap; a search for a detour.
// At three places, and among people, of a costmap of 12 x 8 m with cells of 0.05 m: on open floor, 0.1 m
// beside a wall, and in a door 0.2 m wider than the robot.
//   slalom_navigator_bench [updates]

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <span>
#include <vector>

#include "bench/workload/statistics.hpp"
#include "slalom/navigation/navigator.hpp"
#include "slalom/navigation/path_planner.hpp"

namespace slalom::navigation {
namespace {

const Footprint body = Footprint::rectangle(0.35, 0.35, 0.5);

void fill(maps::OccupancyGrid& grid, double x0, double y0, double x1, double y1) {
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) {
      const double x = (column + 0.5) * grid.resolution, y = (row + 0.5) * grid.resolution;
      if (x > x0 && x < x1 && y > y0 && y < y1) grid.at(column, row) = maps::Occupancy::occupied;
    }
}

/// A hall with a wall along it below y = 2, and one across it at x = 8 with a door at y = 5.
maps::OccupancyGrid hall() {
  maps::OccupancyGrid grid{240, 160, 0.05, {}, {}};
  grid.cells.assign(240 * 160, maps::Occupancy::free);
  fill(grid, 0, 1.9, 8, 2);
  fill(grid, 8, 0, 8.2, 4.65);
  fill(grid, 8, 5.35, 8.2, 8);
  return grid;
}

/// People who walk across the path ahead of (x, y), 1 m apart.
class People {
 public:
  People(int count, double x, double y) {
    for (int i = 0; i < count; ++i) {
      maps::PredictedPose* const poses = poses_[static_cast<std::size_t>(i)];
      for (int h = 0; h < 2; ++h)
        for (int t = 0; t < times; ++t)
          poses[h * times + t] = {{x + 1.2 + i, y - 1.5 + 0.1 * t * (h == 0 ? 0.8 : 0.4), 1.5707963267948966},
                                  0.05 + 0.01 * t,
                                  0.05};
      maps::PredictedObstacle one;
      one.id = i;
      one.length = one.width = 0.5;
      one.interval = 0.1;
      one.hypotheses = 2;
      one.weights = {0.8, 0.2};
      one.poses = {poses, 2 * times};
      all_.push_back(one);
    }
  }
  std::span<const maps::PredictedObstacle> all() const { return all_; }

 private:
  static constexpr int times = 29;
  maps::PredictedPose poses_[8][2 * times];
  std::vector<maps::PredictedObstacle> all_;
};

template <class Work>
void report(const char* what, int count, Work&& work) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    const std::clock_t begin = std::clock();
    work();
    times.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  const workload::TimeStatistics t = workload::time_statistics(times);
  std::printf("%-34s p50 %.3f ms, p99 %.3f, min %.3f, max %.3f\n", what, t.p50, t.p99, t.min, t.max);
}

void run(int updates) {
  const maps::OccupancyGrid grid = hall();
  Costmap costmap(grid.width, grid.height, grid.resolution);
  report("costmap", updates / 4, [&] { costmap.update(grid); });
  PathPlanner planner(costmap.geometry(), body.half_width());
  report("search over the whole costmap", updates / 8, [&] {
    planner.read(costmap, {}, {});
    planner.search_from({2, 5});
  });
  struct Place {
    const char* name;
    maps::Pose pose, goal;
    int people = 0;
  };
  for (const Place& place :
       {Place{"open floor", {3, 5, 0}, {7, 5, 0}}, Place{"among 4 people", {3, 5, 0}, {7, 5, 0}, 4},
        Place{"beside a wall", {3, 2.35, 0}, {7, 2.35, 0}}, Place{"in a door", {7.8, 5, 0}, {11, 5, 0}}}) {
    const maps::Pose path[] = {place.pose, place.goal};
    const People people(place.people, place.pose.x, place.pose.y);
    for (const bool svg : {false, true}) {
      const SolverOptions solver =
          svg ? SolverOptions(svg_mppi_options({})) : SolverOptions(mppi_options({}));
      // The robot of this benchmark stands still.
      Navigator navigator(body, {.stuck_after = 3600}, solver, costmap);
      navigator.set_path(path);
      char what[64];
      std::snprintf(what, sizeof what, "%s, %s", solver.method(), place.name);
      report(what, updates, [&] { navigator.update(place.pose, {0.4, 0, 0}, costmap, 0.05, people.all()); });
    }
  }
}

}  // namespace
}  // namespace slalom::navigation

int main(int count, char** arguments) {
  slalom::navigation::run(count > 1 ? static_cast<int>(std::strtol(arguments[1], nullptr, 10)) : 400);
  return 0;
}
