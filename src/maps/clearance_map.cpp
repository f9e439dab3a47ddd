#include "slalom/maps/clearance_map.hpp"

#include <algorithm>
#include <cmath>

#include "maps/validation.hpp"

namespace slalom::maps {

namespace {

GridGeometry geometry_of(const ClearanceMapOptions& options) {
  validate_options(options, "clearance_map");
  return {detail::cell_count("clearance_map.length_x", options.length_x, options.resolution),
          detail::cell_count("clearance_map.length_y", options.length_y, options.resolution),
          options.resolution, options.center_x, options.center_y};
}

}  // namespace

ClearanceMap::ClearanceMap(const ClearanceMapOptions& options)
    : options_(options),
      geometry_(geometry_of(options)),
      cells_(geometry_.rows, geometry_.columns),
      kernel_reach_(static_cast<int>(std::ceil(options.reach / options.resolution))) {
  for (int i = -kernel_reach_; i <= kernel_reach_; ++i) {
    for (int j = -kernel_reach_; j <= kernel_reach_; ++j) {
      kernel_.push_back(static_cast<float>(options.resolution * std::hypot(i, j)));
    }
  }
  cells_.fill({-1.0F});
  clear();
}

void ClearanceMap::clear() noexcept {
  for (int row = 0; row < geometry_.rows; ++row) {
    std::fill_n(cells_.at(row, 0), geometry_.columns, static_cast<float>(options_.reach));
  }
}

void ClearanceMap::add(std::span<const ScanPoint> points) noexcept {
  for (const ScanPoint& point : points) stamp(point.x, point.y);
}

void ClearanceMap::add(std::span<const Point> points) noexcept {
  for (const Point& point : points) stamp(point.x, point.y);
}

float ClearanceMap::at(double x, double y) const noexcept {
  const int row = geometry_.row(x), column = geometry_.column(y);
  return row < 0 || column < 0 ? -1 : *cells_.at(row, column);
}

void ClearanceMap::stamp(double x, double y) noexcept {
  const double u = (geometry_.center_x - x) / geometry_.resolution + 0.5 * geometry_.rows;
  const double v = (geometry_.center_y - y) / geometry_.resolution + 0.5 * geometry_.columns;
  const int n = kernel_reach_;
  // Also false for what is not finite.
  if (!(u > -n && u < geometry_.rows + n && v > -n && v < geometry_.columns + n)) return;
  const int row = static_cast<int>(std::floor(u)), column = static_cast<int>(std::floor(v));
  const bool inside = row >= 0 && column >= 0 && row < geometry_.rows && column < geometry_.columns;
  if (inside && *cells_.at(row, column) == 0) return;  // neighbouring beams often hit the same cell
  const int begin = std::max(column - n, 0), end = std::min(column + n + 1, geometry_.columns);
  const int width = 2 * n + 1;
  for (int r = std::max(row - n, 0); r < std::min(row + n + 1, geometry_.rows); ++r) {
    const float* kernel = kernel_.data() + (r - row + n) * width + (begin - column + n);
    float* cells = cells_.at(r, begin);
    for (int c = 0; c < end - begin; ++c) cells[c] = std::min(cells[c], kernel[c]);
  }
}

}  // namespace slalom::maps
