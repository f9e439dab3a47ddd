#include "slalom/navigation/footprint.hpp"

#include <algorithm>
#include <utility>

#include "slalom/core/numbers/count.hpp"

namespace slalom::navigation {
namespace {

using maps::Point;

/// Twice the area of a triangle; above 0 if its corners run counter-clockwise.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The distance of a point from the line between `a` and `b`.
double distance_to_segment(const Point& point, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double share =
      squared > 0 ? std::clamp(((point.x - a.x) * dx + (point.y - a.y) * dy) / squared, 0.0, 1.0) : 0;
  return std::hypot(a.x + share * dx - point.x, a.y + share * dy - point.y);
}

bool cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

void check_vertices(std::span<const Point> vertices) {
  const std::size_t count = vertices.size();
  if (count < 3 || count > Footprint::max_vertices)
    throw std::invalid_argument("footprint: " + std::to_string(count) + " vertices, must be 3 to 32");
  for (std::size_t i = 0; i < count; ++i) {
    const auto [x, y] = vertices[i];
    if (!(std::hypot(x, y) <= Footprint::max_extent))
      throw std::invalid_argument("footprint: vertex " + std::to_string(i) + " at (" + std::to_string(x) +
                                  ", " + std::to_string(y) +
                                  "): must be finite and within 100 m of the origin");
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = i + 2; k < count; ++k)
      if (cross(vertices[i], vertices[(i + 1) % count], vertices[k], vertices[(k + 1) % count]))
        throw std::invalid_argument("footprint: the sides from vertex " + std::to_string(i) +
                                    " and from vertex " + std::to_string(k) + " must not cross");
}

/// The lower left and the upper right corner of the box around points.
std::pair<Point, Point> bounds_of(const std::vector<Point>& points) {
  Point low = points.front(), high = low;
  for (const Point& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return {low, high};
}

}  // namespace

Footprint::Footprint(std::span<const Point> vertices) : vertices_(vertices.begin(), vertices.end()) {
  check_vertices(vertices);
  if (!contains({0, 0})) throw std::invalid_argument("footprint: the origin must be inside");
  for (const Point& v : vertices_) {
    circumscribed_ = std::max(circumscribed_, std::hypot(v.x, v.y));
    half_width_ = std::max(half_width_, std::abs(v.y));
  }
  const auto [low, high] = bounds_of(vertices_);
  const bool along_x = high.x - low.x >= high.y - low.y;
  const double from = along_x ? low.x : low.y, length = along_x ? high.x - low.x : high.y - low.y;
  for (int i = 0; i < part_count; ++i)
    parts_[i] = part_of(from + length * i / part_count, from + length * (i + 1) / part_count, along_x);
}

Footprint Footprint::rectangle(double front, double rear, double width) {
  const Point corners[] = {{-rear, -width / 2}, {front, -width / 2}, {front, width / 2}, {-rear, width / 2}};
  return Footprint(corners);
}

/// The part of the body in a strip across the longer side.
Footprint::Part Footprint::part_of(double from, double to, bool along_x) const {
  const double spacing = (to - from) / 100;  // near enough to each other
  std::vector<Point> points;
  for (const Point& p : outline_points(spacing))
    if (const double along = along_x ? p.x : p.y; along >= from - spacing && along <= to + spacing)
      points.push_back(p);
  const auto [low, high] = bounds_of(points);
  Part part{{(low.x + high.x) / 2, (low.y + high.y) / 2}, 0, 0};
  for (const Point& p : points) part.covering = std::max(part.covering, maps::distance(p, part.middle));
  if (contains(part.middle)) part.contained = distance_to_outline(part.middle);
  return part;
}

bool Footprint::contains(const Point& point) const noexcept {
  bool inside = false;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Point &a = vertices_[i], &b = vertices_[(i + 1) % vertices_.size()];
    if ((a.y > point.y) == (b.y > point.y)) continue;
    if (point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

double Footprint::distance_to_outline(const Point& point) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    least = std::min(least, distance_to_segment(point, vertices_[i], vertices_[(i + 1) % vertices_.size()]));
  return least;
}

std::vector<Point> Footprint::outline_points(double spacing) const {
  std::vector<Point> points;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Point &a = vertices_[i], &b = vertices_[(i + 1) % vertices_.size()];
    const std::size_t parts =
        std::max<std::size_t>(1, count(distance(a, b), spacing, 1e4, "footprint: a side"));
    for (std::size_t k = 0; k < parts; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(parts);
      points.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)});
    }
  }
  return points;
}

Footprint Footprint::without_rim(double rim) const {
  const std::size_t n = vertices_.size();
  double area = 0;
  for (std::size_t i = 0; i < n; ++i) area += turn({0, 0}, vertices_[i], vertices_[(i + 1) % n]);
  std::vector<Point> inner = vertices_;
  for (std::size_t i = 0; i < n; ++i) {
    const Point &before = vertices_[(i + n - 1) % n], &here = vertices_[i], &after = vertices_[(i + 1) % n];
    const double a = std::atan2(here.y - before.y, here.x - before.x),
                 b = std::atan2(after.y - here.y, after.x - here.x);
    // Both sides that meet here move to their left, or to their right.
    const double half = 0.5 * maps::wrap_angle(b - a), middle = a + half,
                 way = rim * std::copysign(1.0, area) / std::max(std::cos(half), 0.2);
    inner[i] = {here.x - way * std::sin(middle), here.y + way * std::cos(middle)};
  }
  const bool turned_over = std::any_of(inner.begin(), inner.end(), [&](const Point& p) {
    return rim > 0 && (!contains(p) || distance_to_outline(p) < 0.99 * rim);
  });
  if (!turned_over) {
    try {
      return Footprint(inner);
    } catch (const std::invalid_argument&) {  // nothing is left around the origin
    }
  }
  const double share = std::clamp(1 - rim / half_width_, 0.2, 1.0);
  for (std::size_t i = 0; i < n; ++i) inner[i] = {share * vertices_[i].x, share * vertices_[i].y};
  return Footprint(inner);
}

std::vector<Footprint> Footprint::without_rims(double step) const {
  std::vector<Footprint> bodies{*this};
  for (int i = 1; i < 8; ++i) bodies.push_back(without_rim(i * step));
  bodies.push_back(without_rim(half_width_));
  return bodies;
}

}  // namespace slalom::navigation
