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
  return corridor;
}

double length(const Corridor& corridor) {
  return detail::length(corridor.centre_line, corridor.closed);
}

}  // namespace slalom::vehicle
