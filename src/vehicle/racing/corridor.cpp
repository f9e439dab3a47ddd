#include "slalom/vehicle/racing/corridor.hpp"

#include <cstdio>
#include <numeric>

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "vehicle/course/curve.hpp"

namespace slalom::vehicle {

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
  count(length, step, 1e5, "centre_line");
  const detail::Resampling places = detail::divided_by_step(points, closed, step);
  Corridor corridor{.centre_line = places.points, .closed = closed};
  for (std::size_t k = 0; k < places.points.size(); ++k) {
    const std::size_t row = places.row[k], next = (row + 1) % n;
    const double t = places.share[k];
    corridor.left.push_back((1 - t) * left[row] + t * left[next]);
    corridor.right.push_back((1 - t) * right[row] + t * right[next]);
  }
  corridor.normal = detail::normals(corridor.centre_line, closed);
  return corridor;
}

void check_walls(const Corridor& corridor) {
  constexpr double exact = 0.9, opposite = -0.5, beside = 0.8, folded = 0.5;
  const auto& line = corridor.centre_line;
  double widest = 0;
  for (std::size_t i = 0; i < line.size(); ++i)
    widest = std::max({widest, corridor.left[i], corridor.right[i]});
  std::vector<std::size_t> by_x(line.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) { return line[a].x < line[b].x; });
  for (std::size_t m = 0; m < by_x.size(); ++m)
    for (std::size_t n = m + 1; n < by_x.size(); ++n) {
      const std::size_t i = by_x[m], k = by_x[n];
      const maps::Point way{line[k].x - line[i].x, line[k].y - line[i].y};
      if (way.x >= 2 * widest) break;
      const maps::Point &here = corridor.normal[i], &there = corridor.normal[k];
      if (here.x * there.x + here.y * there.y > opposite) continue;
      const double apart = std::hypot(way.x, way.y), side = here.x * way.x + here.y * way.y;
      const auto& widths = side > 0 ? corridor.left : corridor.right;
      // A line that turns back on itself has no side.
      const double narrow =
          std::min(corridor.left[i], corridor.right[i]) + std::min(corridor.left[k], corridor.right[k]);
      if (apart >= folded * narrow &&
          (apart >= exact * (widths[i] + widths[k]) || std::abs(side) < beside * apart))
        continue;
      char text[300];
      std::snprintf(
          text, sizeof text,
          "centre_line: its walls cross: the parts at (%.2f, %.2f) and (%.2f, %.2f) are %.2f m apart, "
          "and their widths to this side are %.2f and %.2f m; together they must be at most their "
          "distance",
          line[i].x, line[i].y, line[k].x, line[k].y, apart, widths[i], widths[k]);
      throw std::invalid_argument(text);
    }
}

double length(const Corridor& corridor) {
  return detail::length(corridor.centre_line, corridor.closed);
}

}  // namespace slalom::vehicle
