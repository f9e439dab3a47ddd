#pragma once

#include <cstdint>
#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::maps {

/// The state of a cell.
enum class Occupancy : std::uint8_t { free, occupied, unknown };

/// A map of square cells, row-major, row 0 at the bottom. The pose of the lower left corner of cell (0, 0) in
/// the map frame is `origin`; its yaw turns the whole grid about that corner.
struct OccupancyGrid {
  int width = 0;                 ///< cells along the grid's x
  int height = 0;                ///< cells along the grid's y
  double resolution = 0;         ///< m per cell
  Pose origin;                   ///< pose of the lower left corner, map frame
  std::vector<Occupancy> cells;  ///< height x width

  /// Occupancy of a cell.
  Occupancy at(int column, int row) const { return cells[static_cast<std::size_t>(row) * width + column]; }
  /// Occupancy of a cell.
  Occupancy& at(int column, int row) { return cells[static_cast<std::size_t>(row) * width + column]; }
  /// Whether the cell exists.
  bool contains(int column, int row) const {
    return column >= 0 && row >= 0 && column < width && row < height;
  }
};

/// Throws std::invalid_argument unless a grid has width x height cells, at least one, a resolution that is
/// finite and above 0, and an origin within PoseLimits.
void check_grid(const OccupancyGrid& grid);

}  // namespace slalom::maps
