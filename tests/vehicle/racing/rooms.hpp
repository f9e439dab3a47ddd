#pragma once

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/vehicle/racing/corridor.hpp"

/// Places for tests of courses.
namespace slalom::testing {

constexpr double pi = 3.14159265358979323846;

/// A map without anything known, cells of 0.05 m, origin in the lower left corner.
inline maps::OccupancyGrid unknown_map(double width, double height, double x = 0, double y = 0) {
  const auto cells = [](double length) { return static_cast<int>(std::lround(length / 0.05)); };
  maps::OccupancyGrid map{cells(width), cells(height), 0.05, {x, y, 0}, {}};
  map.cells.assign(static_cast<std::size_t>(map.width) * map.height, maps::Occupancy::unknown);
  return map;
}

/// Sets the cells whose centres are in a rectangle, map frame.
inline void fill(maps::OccupancyGrid& map, double x0, double y0, double x1, double y1, maps::Occupancy kind) {
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column) {
      const double x = map.origin.x + (column + 0.5) * map.resolution,
                   y = map.origin.y + (row + 0.5) * map.resolution;
      if (x > x0 && x < x1 && y > y0 && y < y1) map.at(column, row) = kind;
    }
}

/// A rectangular corridor, 2 m wide between walls of 0.2 m; its centre line runs through (0, 0), (16, 0),
/// (16, 8) and (0, 8). The infield and all outside are unknown.
inline maps::OccupancyGrid rectangular_course() {
  maps::OccupancyGrid map = unknown_map(22, 14, -3, -3);
  fill(map, -1.2, -1.2, 17.2, 9.2, maps::Occupancy::occupied);
  fill(map, -1, -1, 17, 9, maps::Occupancy::free);
  fill(map, 1, 1, 15, 7, maps::Occupancy::occupied);
  fill(map, 1.2, 1.2, 14.8, 6.8, maps::Occupancy::unknown);
  return map;
}

/// A corridor of constant width along a circle or a straight line along x.
inline vehicle::Corridor circle(double radius, double half_width) {
  std::vector<maps::Point> points;
  for (int i = 0; i < 100; ++i)
    points.push_back({radius * std::cos(2 * pi * i / 100), radius * std::sin(2 * pi * i / 100)});
  const std::vector<double> widths(100, half_width);
  return vehicle::corridor_from_widths(points, widths, widths, true, 0.2);
}
inline vehicle::Corridor straight(double length, double half_width) {
  std::vector<maps::Point> points;
  for (int i = 0; i <= 20; ++i) points.push_back({length * i / 20, 0});
  const std::vector<double> widths(21, half_width);
  return vehicle::corridor_from_widths(points, widths, widths, false, 0.2);
}

}  // namespace slalom::testing
