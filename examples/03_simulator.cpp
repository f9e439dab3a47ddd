// The simulator alone: two cars and a barrel on a ring road. The first car drives a lap by its LiDAR: it
// steers towards the side with more room.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <vector>

#include <slalom/sim/world.hpp>

namespace maps = slalom::maps;
namespace sim = slalom::sim;

/// A ring road, 3 m wide, around (10, 10) m.
maps::OccupancyGrid ring_road() {
  maps::OccupancyGrid grid{400, 400, 0.05, {}, std::vector<maps::Occupancy>(160000, maps::Occupancy::free)};
  for (int row = 0; row < 400; ++row)
    for (int column = 0; column < 400; ++column) {
      const double distance = std::hypot(0.05 * (column + 0.5) - 10, 0.05 * (row + 0.5) - 10);
      if (distance < 5 || distance > 8) grid.at(column, row) = maps::Occupancy::occupied;
    }
  return grid;
}

/// Its middle line, counter-clockwise.
sim::LapPath middle_line() {
  std::vector<maps::Point> points;
  for (int i = 0; i < 100; ++i) {
    const double angle = 2 * std::numbers::pi * i / 100;
    points.push_back({10 + 6.5 * std::cos(angle), 10 + 6.5 * std::sin(angle)});
  }
  return sim::LapPath(std::move(points));
}

/// Steers towards the side with more room: the mean range between 15 and 75 degrees, at most 3 m a beam.
slalom::Command keep_between_walls(const maps::LaserScanView& scan) {
  double room[2] = {0, 0};  // m, to the right and to the left
  int beams[2] = {0, 0};
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double angle = scan.angle_min + scan.angle_increment * static_cast<double>(i);
    if (std::abs(angle) < 0.26 || std::abs(angle) > 1.3) continue;
    room[angle > 0] += std::min(static_cast<double>(scan.ranges[i]), 3.0);
    ++beams[angle > 0];
  }
  return {std::clamp(0.4 * (room[1] / beams[1] - room[0] / beams[0]), -0.4, 0.4), 2};
}

int main() {
  const auto track = std::make_shared<const sim::Track>(ring_road(), middle_line());
  sim::World world({}, track);
  const double quarter = std::numbers::pi / 2;
  world.reset(1, std::array{maps::Pose{16.5, 10, quarter}, maps::Pose{3.0, 10, -quarter}});
  world.add_disc({{10, 17.3}, 0.12});
  while (world.laps(0)->laps() < 1 && world.time() < 60) {
    world.step(std::array{keep_between_walls(world.observe(0).scan), slalom::Command{0, 0}});
    if (world.observe(0).collides()) break;
  }
  std::printf("%d lap in %.1f s, %zu beams\n", world.laps(0)->laps(), world.time(),
              world.observe(0).scan.ranges.size());
  return world.laps(0)->laps() == 1 ? 0 : 1;
}
