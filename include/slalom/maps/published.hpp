#pragma once

/// Parts that only reproduce the program that the authors of SVG-MPPI published (K. Honda, proj-svg_mppi):
/// deviations of its maps, all off by default, and its settings.
namespace slalom::maps {

struct LocalCostMapOptions;
struct ReferenceFieldOptions;

/// Deviations of the published program's cost map.
struct PublishedCostMap {
  /// The cell of an obstacle is inflated by whole cells, ceil(reach / resolution) to each side as a half-open
  /// range. That is one cell less towards smaller x and y than towards larger ones: 0.15 m to the left, 0.10
  /// m to the right. There is no soft margin. The default marks every cell in which some position lets the
  /// footprint reach the point.
  bool half_open_inflation = false;
  /// A point outside the map is ignored, also where its inflation reaches into the map.
  bool forget_points_outside = false;
};

/// The published program's cost map.
LocalCostMapOptions published_cost_map();
/// The published program's reference field.
ReferenceFieldOptions published_reference_field();

}  // namespace slalom::maps
