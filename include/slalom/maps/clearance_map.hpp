#pragma once

#include "slalom/core/grid_view.hpp"
#include "slalom/core/options.hpp"
#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/local_cost_map.hpp"

namespace slalom::maps {

/// Options of ClearanceMap. `visit_options` below describes the fields.
struct ClearanceMapOptions {
  double length_x = 10;
  double length_y = 10;
  double resolution = 0.05;
  double center_x = 3;
  double center_y = 0;
  double reach = 0.5;
};

template <class Options, class Visit>
requires is_options_of<Options, ClearanceMapOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.length_x, {"length_x", "m", "length of the map", 1e-3, 1e4});
  visit(o.length_y, {"length_y", "m", "width of the map", 1e-3, 1e4});
  visit(o.resolution, {"resolution", "m", "size of a cell", 1e-4, 100});
  visit(o.center_x, {"center_x", "m", "centre of the map, ahead of the robot", -1e4, 1e4});
  visit(o.center_y, {"center_y", "m", "centre of the map, to the left of the robot", -1e4, 1e4});
  visit(o.reach, {"reach", "m", "largest distance to an obstacle that is known", 1e-3, 100});
}

/// A map in the robot's frame that holds for every cell the distance (m) to the nearest obstacle point, up to
/// a reach. A body of discs needs no more, at any heading. Points count as the centres of their cells, so the
/// error of a distance is at most one cell. The border cells around the map hold -1. After construction
/// nothing allocates.
class ClearanceMap {
 public:
  /// Throws std::invalid_argument where the options break a rule.
  explicit ClearanceMap(const ClearanceMapOptions& options = {});

  /// Forgets all obstacles.
  void clear() noexcept;
  /// Adds obstacle points in the robot's frame, m; those off the map by more than the reach do not matter.
  void add(std::span<const ScanPoint> points) noexcept;
  /// Adds obstacle points in the robot's frame, m.
  void add(std::span<const Point> points) noexcept;

  /// The distance at a position in the robot's frame, m, at most the reach; -1 off the map.
  float at(double x, double y) const noexcept;

  /// Position and size of the cells.
  const GridGeometry& geometry() const noexcept { return geometry_; }
  /// View for look-ups.
  GridView<1> view() const noexcept { return cells_.view(geometry_); }

 private:
  void stamp(double x, double y) noexcept;

  ClearanceMapOptions options_;
  GridGeometry geometry_;
  CellGrid<1> cells_;
  int kernel_reach_ = 0;       ///< cells
  int kernel_width_ = 0;       ///< values of a row of the kernel: 2 reach + 1, padded with `reach` (m)
  std::vector<float> kernel_;  ///< 2 reach + 1 rows of distances, m
};

}  // namespace slalom::maps
