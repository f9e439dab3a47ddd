#pragma once

#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::vehicle::detail {

/// m along the points, and back to the first if the line is closed.
double line_length(const std::vector<maps::Point>& points, bool closed);

/// Unit normals to the left, from the points before and after.
std::vector<maps::Point> line_normals(const std::vector<maps::Point>& points, bool closed);

/// A line convolved with a Gaussian of standard deviation `width` (m) along its length. Its steps must be
/// about equal. An open line keeps its ends.
std::vector<maps::Point> line_smoothed(const std::vector<maps::Point>& points, bool closed, double width);

/// Values at the points of a line, smoothed in the same way.
std::vector<double> values_smoothed(const std::vector<double>& values, bool closed, double reach);

/// New points of a line and where they are on the old one.
struct Resampling {
  std::vector<maps::Point> points;  ///< points at equal steps
  std::vector<std::size_t> row;     ///< row of the old point before each
  std::vector<double> share;        ///< share of the way to the next old point, 0..1
};

/// Points at equal steps of about `step` (m), by Catmull-Rom cubics through the points of the line.
Resampling equal_steps(const std::vector<maps::Point>& points, bool closed, double step);

}  // namespace slalom::vehicle::detail
