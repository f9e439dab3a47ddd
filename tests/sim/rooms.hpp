#pragma once

#include <memory>

#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/track.hpp"

namespace slalom::testing {

/// A closed room: walls one cell thick round `width` x `height` cells; the corner of the map at (0, 0).
inline maps::OccupancyGrid room(int width, int height, double resolution = 0.05) {
  maps::OccupancyGrid grid{width, height, resolution, {}, {}};
  grid.cells.assign(width * height, maps::Occupancy::free);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      if (r == 0 || c == 0 || r == height - 1 || c == width - 1) grid.at(c, r) = maps::Occupancy::occupied;
  return grid;
}

/// A ring road about (10, 10): free between 4 and 7 m from there, on a map of 20 x 20 m.
inline maps::OccupancyGrid ring_road() {
  maps::OccupancyGrid grid = room(400, 400);
  for (int r = 0; r < 400; ++r)
    for (int c = 0; c < 400; ++c) {
      const double d = std::hypot(0.05 * (c + 0.5) - 10, 0.05 * (r + 0.5) - 10);
      if (d < 4 || d > 7) grid.at(c, r) = maps::Occupancy::occupied;
    }
  return grid;
}

inline std::vector<maps::Point> circle(double radius, int points = 200) {
  std::vector<maps::Point> path;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * 3.141592653589793 * i / points;
    path.push_back({10 + radius * std::cos(angle), 10 + radius * std::sin(angle)});
  }
  return path;
}

/// The middle of the ring road at this speed (m/s), counter-clockwise.
inline std::vector<sim::PathPoint> ring_path(double speed) {
  std::vector<sim::PathPoint> path;
  for (const maps::Point& point : circle(5.5)) path.push_back({point, speed});
  return path;
}

/// A pose on the ring road: `angle` (rad) about its middle, at `radius` (m), heading counter-clockwise.
inline maps::Pose on_ring(double angle, double radius = 5.5) {
  return {10 + radius * std::cos(angle), 10 + radius * std::sin(angle),
          maps::wrap_angle(angle + 0.5 * 3.141592653589793)};
}

inline std::shared_ptr<const sim::Track> ring_track() {
  return std::make_shared<const sim::Track>(ring_road(), sim::LapPath(circle(5.5)));
}

}  // namespace slalom::testing
