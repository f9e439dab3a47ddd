#pragma once

#include <vector>

#include "slalom/maps/occupancy_grid.hpp"

namespace slalom::maps {

/// The exact Euclidean distance from the centre of every cell to the centre of the nearest obstacle cell, in
/// metres; 0 on obstacles. Outside the grid there are no obstacles. Without any obstacle every distance is
/// infinite.
struct DistanceField {
  int width = 0;                 ///< cells
  int height = 0;                ///< cells
  double resolution = 0;         ///< m per cell
  Pose origin;                   ///< pose of the corner, as in OccupancyGrid
  std::vector<double> distance;  ///< height x width, row 0 at the bottom, m

  /// Distance from a cell to the nearest occupied cell, m.
  double at(int column, int row) const { return distance[static_cast<std::size_t>(row) * width + column]; }
};

/// Exact Euclidean distance transform in linear time by lower envelopes of parabolas (Felzenszwalb &
/// Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8, 2012). Unknown cells
/// count as obstacles if `unknown_is_obstacle`. Throws std::invalid_argument unless the grid has width x
/// height cells, at least one.
DistanceField distance_transform(const OccupancyGrid& grid, bool unknown_is_obstacle);

}  // namespace slalom::maps
