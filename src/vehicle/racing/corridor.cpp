#include "slalom/vehicle/racing/corridor.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "vehicle/course/curve.hpp"

namespace slalom::vehicle {
namespace {

constexpr double max_corridor_points = 1e5;

/// Throws std::invalid_argument where two parts of a corridor that lead in opposite directions overlap: no
/// wall is between them. Widths may be a tenth too large.
void check_walls(const Corridor& corridor) {
  constexpr double exact = 0.9;
  const auto& line = corridor.centre_line;
  for (std::size_t i = 0; i < line.size(); ++i)
    for (std::size_t k = i + 1; k < line.size(); ++k) {
      const maps::Point way{line[k].x - line[i].x, line[k].y - line[i].y}, &here = corridor.normal[i],
                                                                           &there = corridor.normal[k];
      const double apart = std::hypot(way.x, way.y), side = here.x * way.x + here.y * way.y;
      const auto& widths = side > 0 ? corridor.left : corridor.right;
      if (apart >= exact * (widths[i] + widths[k]) || here.x * there.x + here.y * there.y > -0.5) continue;
      if (std::abs(side) < 0.8 * apart) continue;
      throw std::invalid_argument("centre_line: its walls cross: the parts at (" + std::to_string(line[i].x) +
                                  ", " + std::to_string(line[i].y) + ") and (" + std::to_string(line[k].x) +
                                  ", " + std::to_string(line[k].y) + ") are " + std::to_string(apart) +
                                  " m apart, and their widths to this side are " + std::to_string(widths[i]) +
                                  " and " + std::to_string(widths[k]) +
                                  " m; together they must be at most their distance");
    }
}

}  // namespace

Corridor corridor_from_widths(const std::vector<maps::Point>& points, const std::vector<double>& left,
                              const std::vector<double>& right, bool closed, double step) {
  const std::size_t n = points.size();
  if (n < 4)
    throw std::invalid_argument("centre_line: " + std::to_string(n) + " points; at least 4 are needed");
  if (left.size() != n || right.size() != n)
    throw std::invalid_argument("centre_line: points and widths must have the same number");
  if (!(step > 0)) throw std::invalid_argument("step: " + to_text(step) + " must be above 0 m");
  maps::check_points("centre_line", points);
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(left[i]) || !std::isfinite(right[i]))
      throw std::invalid_argument("centre_line: the widths at point " + std::to_string(i) +
                                  " must be finite");
  const double length = detail::length(points, closed);
  if (!(length > 0)) throw std::invalid_argument("centre_line: all points are the same");
  count(length, step, max_corridor_points, "centre_line");
  const detail::Resampling places = detail::divided_by_step(points, closed, step);
  Corridor corridor;
  corridor.closed = closed;
  corridor.centre_line = places.points;
  for (std::size_t k = 0; k < places.points.size(); ++k) {
    const std::size_t row = places.row[k], next = (row + 1) % n;
    const double t = places.share[k];
    corridor.left.push_back((1 - t) * left[row] + t * left[next]);
    corridor.right.push_back((1 - t) * right[row] + t * right[next]);
  }
  corridor.normal = detail::normals(corridor.centre_line, closed);
  check_walls(corridor);
  return corridor;
}

double length(const Corridor& corridor) {
  return detail::length(corridor.centre_line, corridor.closed);
}

}  // namespace slalom::vehicle
