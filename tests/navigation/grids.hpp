#pragma once

#include "slalom/navigation/costmap.hpp"

namespace slalom::navigation {

/// A grid of free cells of 0.05 m whose lower left corner lies at (x, y), m.
inline maps::OccupancyGrid free_grid(double x, double y, double length_x, double length_y) {
  maps::OccupancyGrid grid;
  grid.resolution = 0.05;
  grid.width = static_cast<int>(std::lround(length_x / grid.resolution));
  grid.height = static_cast<int>(std::lround(length_y / grid.resolution));
  grid.origin = {x, y, 0};
  grid.cells.assign(grid.width * grid.height, maps::Occupancy::free);
  return grid;
}

/// Sets the cells whose middles lie in a rectangle, m.
inline void fill(maps::OccupancyGrid& grid, double x0, double y0, double x1, double y1,
                 maps::Occupancy value = maps::Occupancy::occupied) {
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) {
      const double x = grid.origin.x + (column + 0.5) * grid.resolution,
                   y = grid.origin.y + (row + 0.5) * grid.resolution;
      if (x >= x0 && x <= x1 && y >= y0 && y <= y1) grid.at(column, row) = value;
    }
}

inline Costmap costmap_of(const maps::OccupancyGrid& grid, UnknownCells unknown = UnknownCells::obstacle) {
  Costmap costmap(grid.width, grid.height, grid.resolution, unknown);
  return costmap.update(grid) ? costmap : throw std::invalid_argument("the costmap refuses the grid");
}

}  // namespace slalom::navigation
