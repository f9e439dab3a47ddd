#include "slalom/maps/course_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "maps/validation.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::maps {
namespace {

GridGeometry geometry_of(std::span<const ReferencePoint> path, const CourseFieldOptions& options) {
  options.validate();
  check_reference_path(path);
  const auto [west, east] =
      std::minmax_element(path.begin(), path.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [south, north] =
      std::minmax_element(path.begin(), path.end(), [](auto& a, auto& b) { return a.y < b.y; });
  const double margin = 2 * (options.corridor + options.resolution);
  const double rows = std::ceil((east->x - west->x + margin) / options.resolution);
  const double columns = std::ceil((north->y - south->y + margin) / options.resolution);
  detail::require(rows * columns <= std::int64_t{1} << 26, "course field: number of cells", rows * columns,
                  "at most 2^26; use a coarser resolution or a narrower corridor");
  return {static_cast<int>(rows), static_cast<int>(columns), options.resolution, 0.5 * (west->x + east->x),
          0.5 * (south->y + north->y)};
}

/// A stretch between two points of the path.
struct Segment {
  double x, y;            ///< start of the segment, m
  double dx, dy;          ///< to its end, m
  double inverse_square;  ///< 1 / length^2, 0 for coincident ends
  double yaw, turn;       ///< direction at the start, change to the end; rad
  double speed, gain;     ///< at the start, change to the end; m/s

  /// The place on the segment, 0 .. 1, of the point nearest to a position.
  double nearest(double px, double py) const {
    return std::clamp(((px - x) * dx + (py - y) * dy) * inverse_square, 0.0, 1.0);
  }
  double squared_distance(double px, double py) const {
    const double t = nearest(px, py), ex = px - (x + t * dx), ey = py - (y + t * dy);
    return ex * ex + ey * ey;
  }
};

std::vector<Segment> segments_of(std::span<const ReferencePoint> path, bool closed) {
  const std::size_t points = path.size(), count = closed ? points : points - 1;
  std::vector<Segment> segments(count);
  std::vector<double> own_yaw(count);
  for (std::size_t i = 0; i < count; ++i) {
    const ReferencePoint &a = path[i], &b = path[(i + 1) % points];
    const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
    segments[i] = {a.x, a.y, dx, dy, square > 0 ? 1 / square : 0, 0, 0, a.speed, b.speed - a.speed};
    // A stretch without length has the direction of the one before it.
    own_yaw[i] = square > 0 || i == 0 ? std::atan2(dy, dx) : own_yaw[i - 1];
  }
  const auto yaw_at = [&](std::size_t point) {
    if (!closed && point == 0) return own_yaw[0];
    if (!closed && point == count) return own_yaw[count - 1];
    const double before = own_yaw[(point + count - 1) % count], after = own_yaw[point % count];
    return wrap_angle(before + 0.5 * wrap_angle(after - before));
  };
  for (std::size_t i = 0; i < count; ++i) {
    segments[i].yaw = yaw_at(i);
    segments[i].turn = wrap_angle(yaw_at(closed ? (i + 1) % count : i + 1) - segments[i].yaw);
  }
  return segments;
}

}  // namespace

void CourseFieldOptions::validate() const {
  validate_options(*this, "course_field");
}

CourseField::CourseField(std::span<const ReferencePoint> path, const CourseFieldOptions& options)
    : options_(options), geometry_(geometry_of(path, options)), cells_(geometry_.rows, geometry_.columns) {
  cells_.fill({static_cast<float>(options.outside.distance), static_cast<float>(options.outside.yaw),
               static_cast<float>(options.outside.speed), 1});
  make_cells(path);
}

void CourseField::make_cells(std::span<const ReferencePoint> path) {
  const auto segments = segments_of(path, options_.closed);
  const double reach = options_.corridor, resolution = geometry_.resolution;
  const double top_x = geometry_.cell_x(0), top_y = geometry_.cell_y(0);
  const auto columns = static_cast<std::size_t>(geometry_.columns);
  std::vector<double> best(static_cast<std::size_t>(geometry_.rows) * columns, reach * reach);
  std::vector<std::int32_t> owner(best.size(), -1);
  // Only the cells of a segment's neighbourhood can have it as their nearest within the corridor.
  const auto first = [&](double top, double high) {
    return static_cast<int>(std::max((top - high) / resolution, 0.0));
  };
  const auto last = [&](double top, double low, int count) {
    return static_cast<int>(std::min((top - low) / resolution + 1, static_cast<double>(count)));
  };
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const Segment& segment = segments[s];
    const double end_x = segment.x + segment.dx, end_y = segment.y + segment.dy;
    const int row_end = last(top_x, std::min(segment.x, end_x) - reach, geometry_.rows);
    const int column_begin = first(top_y, std::max(segment.y, end_y) + reach);
    const int column_end = last(top_y, std::min(segment.y, end_y) - reach, geometry_.columns);
    for (int row = first(top_x, std::max(segment.x, end_x) + reach); row < row_end; ++row) {
      const double x = geometry_.cell_x(row);
      for (int column = column_begin; column < column_end; ++column) {
        const double squared = segment.squared_distance(x, geometry_.cell_y(column));
        const std::size_t cell = static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
        if (squared < best[cell]) {
          best[cell] = squared;
          owner[cell] = static_cast<std::int32_t>(s);
        }
      }
    }
  }
  for (int row = 0; row < geometry_.rows; ++row) {
    for (int column = 0; column < geometry_.columns; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
      if (owner[i] < 0) continue;
      const Segment& segment = segments[static_cast<std::size_t>(owner[i])];
      const double t = segment.nearest(geometry_.cell_x(row), geometry_.cell_y(column));
      float* cell = cells_.at(row, column);
      cell[0] = static_cast<float>(std::sqrt(best[i]));
      cell[1] = static_cast<float>(wrap_angle(segment.yaw + t * segment.turn));
      cell[2] = static_cast<float>(segment.speed + t * segment.gain);
    }
  }
}

ReferenceCell CourseField::at(double x, double y) const noexcept {
  const int row = geometry_.row(x), column = geometry_.column(y);
  const float* cell = row < 0 || column < 0 ? cells_.data() : cells_.at(row, column);
  return {cell[0], cell[1], cell[2], cell[3]};
}

}  // namespace slalom::maps
