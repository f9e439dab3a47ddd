#pragma once

#include <span>

#include "slalom/maps/occupancy_grid.hpp"

namespace slalom::maps {

/// The exact Euclidean distance from the centre of every cell to the centre of the nearest obstacle cell, in
/// metres; 0 on obstacles. Outside the grid there are no obstacles. Without any, distances are infinite.
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
/// count as obstacles if `unknown_is_obstacle`. Throws as check_grid does.
DistanceField distance_transform(const OccupancyGrid& grid, bool unknown_is_obstacle);

/// The same transform for grids of one size, computed over and over: after construction nothing allocates.
class DistanceTransform {
 public:
  /// For grids of this size, in cells. Throws std::invalid_argument unless both are at least 1.
  DistanceTransform(int width, int height);

  /// Writes the distances (m) from cells of this `resolution` (m) to `distance`. Both spans hold
  /// height x width values, row 0 at the bottom.
  void compute(std::span<const Occupancy> cells, bool unknown_is_obstacle, double resolution,
               std::span<double> distance) noexcept;

 private:
  /// A parabola of the lower envelope of (x - site)^2 + height over one row.
  struct Parabola {
    std::int32_t site;
    std::int64_t height;  ///< squared, cells^2
    double start;         ///< place from which the parabola is the lowest
  };

  void measure_columns(std::span<const Occupancy> cells, bool unknown_is_obstacle) noexcept;
  int build_envelope(const std::int32_t* vertical) noexcept;
  void evaluate(int count, double resolution, double* distance) const noexcept;

  int width_, height_;
  std::vector<std::int32_t> vertical_;  ///< cells, to the nearest obstacle of the same column
  std::vector<Parabola> envelope_;
};

}  // namespace slalom::maps
