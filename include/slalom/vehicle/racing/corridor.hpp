#pragma once

#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::vehicle {

/// The free space along a line: at each point how far it is to the walls on both sides.
struct Corridor {
  std::vector<maps::Point> centre_line;  ///< m; of a closed corridor the first is not repeated at the end
  std::vector<maps::Point> normal{};     ///< unit vectors to the left, a point each
  std::vector<double> left{}, right{};   ///< m from the point to the wall along the normal, a point each
  bool closed = true;                    ///< whether the first point follows the last one
};

/// The corridor along a line of points in the direction of driving. `left` and `right` are the widths (m) at
/// these points. The points are replaced by points at equal steps of about `step` (m), the normals are those
/// of the smoothed line. Throws std::invalid_argument on fewer than 4 points, sizes that differ, values that
/// are not finite, a step that is not above 0, or more than 100,000 steps.
Corridor corridor_from_widths(const std::vector<maps::Point>& points, const std::vector<double>& left,
                              const std::vector<double>& right, bool closed, double step);

/// Throws std::invalid_argument with both places where two parts of a corridor that lead in opposite
/// directions overlap, so that no wall is between them. Widths may be a tenth too large.
void check_walls(const Corridor& corridor);

/// The length of the centre line, m.
double length(const Corridor& corridor);

}  // namespace slalom::vehicle
