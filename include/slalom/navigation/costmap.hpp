#pragma once

#include "slalom/core/grid_view.hpp"
#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/distance_field.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/navigation/footprint.hpp"

namespace slalom::navigation {

/// The treatment of cells of which nothing is known.
enum class UnknownCells {
  obstacle,  ///< obstacles
  priced,    ///< places that the robot may enter at a price
};
inline const char* const* enum_names(UnknownCells) {
  static constexpr const char* const names[] = {"obstacle", "priced", nullptr};
  return names;
}

/// The obstacles around a robot: a grid of square cells parallel to the map frame, with the distance from
/// each to the nearest obstacle cell. The grid may move with the robot from update to update. Positions off
/// the grid are unknown. After construction nothing allocates.
class Costmap {
 public:
  /// For grids of this size in cells with this resolution (m). Throws std::invalid_argument unless the grid
  /// has 3 to 20000 cells along each side, and the resolution is in [0.001, 10].
  Costmap(int width, int height, double resolution, UnknownCells unknown = UnknownCells::obstacle);

  /// Takes the cells of `grid`, and your own prices of them, in the same order: being in a cell with price 1
  /// costs as much as being in an unknown cell (CostOptions::unknown), and a search pays twice its length.
  /// Prices are at most 1e6; those that are negative or not numbers count as 0. Returns false and changes
  /// nothing if the size or resolution of the grid is another, the number of prices is neither 0 nor that of
  /// the cells, the origin of the grid is beyond maps::PoseLimits, or it is turned (its yaw is not 0).
  bool update(const maps::OccupancyGrid& grid, std::span<const float> prices = {}) noexcept;

  /// The distance (m) from the middle of the cell at a position (m) to that of the nearest obstacle cell, at
  /// most `reach`.
  double distance(double x, double y) const noexcept;
  /// Whether the body at this pose (map frame) overlaps an obstacle cell: exact but for rounding. One look-up
  /// of the distance decides for most poses. A pose beyond maps::PoseLimits collides.
  bool collides(const Footprint& footprint, const maps::Pose& pose) const noexcept {
    return collides(footprint, pose, pose);
  }
  /// Whether the body overlaps an obstacle cell at `to`, or on the straight way from `from`, turning evenly.
  bool collides(const Footprint& footprint, const maps::Pose& from, const maps::Pose& to) const noexcept;

  /// The distances of all cells, for rollouts in the map frame.
  GridView<1> distances() const noexcept { return distances_.view(geometry_); }
  /// The prices of all cells: your own, and 1 more where they are unknown and priced.
  GridView<1> prices() const noexcept { return prices_.view(geometry_); }
  /// Position and size of the cells.
  const maps::GridGeometry& geometry() const noexcept { return geometry_; }

  static constexpr float reach = Footprint::max_extent;  ///< m, the largest distance told

 private:
  bool touches(const Footprint& footprint, const maps::Pose& from, const maps::Pose& to) const noexcept;

  UnknownCells unknown_;
  maps::GridGeometry geometry_;
  maps::DistanceTransform transform_;
  std::vector<double> transformed_;  ///< m, height x width
  maps::CellGrid<1> distances_, prices_;
};

}  // namespace slalom::navigation
