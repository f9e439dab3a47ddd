#pragma once

#include <span>
#include <vector>

#include "slalom/core/options.hpp"
#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/reference_path.hpp"

namespace slalom::maps {

/// Options of CourseField.
/// `visit_options` below describes the fields.
struct CourseFieldOptions {
  double resolution = 0.1;
  double corridor = 5;
  bool closed = true;
  ReferenceOutside outside{};  ///< result of a look-up off the map or the corridor

  /// Throws std::invalid_argument naming the field, its value and the rule.
  void validate() const;
};

template <class Options, class Visit>
requires is_options_of<Options, CourseFieldOptions>
void visit_options(Options& options, Visit&& visit) {
  visit(options.resolution, {"resolution", "m", "size of a cell", 1e-4, 100});
  visit(options.corridor,
        {"corridor", "m", "half width of the strip around the path; cells beyond it count as off the map",
         1e-3, 1e4});
  visit(options.closed, {"closed", "", "the last point leads on to the first"});
  visit_reference_outside(options.outside, visit);
}

/// A map of a whole course, fixed in the map frame, that holds for every cell the distance of its centre to
/// the path, with the path's yaw and speed there. The path is the polyline through the points: the nearest
/// point may lie anywhere on a segment, ahead of the car or behind it; yaw and speed are interpolated between
/// the segment's ends. The direction at a point is the mean of the two segments that meet there; the points'
/// own `yaw` is not used.
///
/// It is made once, so that driving costs nothing, at the price of one blind spot: where two stretches of the
/// course run within a corridor's width of each other, a car far from its own stretch is drawn to the other.
/// ReferenceField, which knows only a window of the path, is for such courses.
class CourseField {
 public:
  /// Throws std::invalid_argument where the path or the options break a rule, or the map would have more than
  /// 2^26 cells.
  explicit CourseField(std::span<const ReferencePoint> path, const CourseFieldOptions& options = {});

  /// The cell at a position, m.
  ReferenceCell at(double x, double y) const noexcept;

  /// The options given at construction.
  const CourseFieldOptions& options() const noexcept { return options_; }
  /// Position and size of the cells.
  const GridGeometry& geometry() const noexcept { return geometry_; }
  /// The cells.
  const CellGrid<4>& cells() const noexcept { return cells_; }

  /// The cells {distance, yaw, speed, 0}, in the map frame, for the look-ups of rollouts. Those off the
  /// corridor hold the values of CourseFieldOptions::outside, and 1 in the last place.
  GridView<4> view() const noexcept { return cells_.view(geometry_); }

 private:
  void make_cells(std::span<const ReferencePoint> path);

  CourseFieldOptions options_;
  GridGeometry geometry_;
  CellGrid<4> cells_;
};

}  // namespace slalom::maps
