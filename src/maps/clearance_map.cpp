#include "slalom/maps/clearance_map.hpp"

#include "maps/validation.hpp"
#include "slalom/core/dispatch.hpp"
#include "slalom/core/math.hpp"
#include "slalom/core/sequence_batch.hpp"

namespace slalom::maps {

namespace {

/// Lowers cells to the distances from one point. Rows of distances have `width` values, a multiple of the
/// padding; the values beyond the kernel are larger than any cell.
struct Lower {
  template <class Target>
  SLALOM_KERNEL static void run(const float* distances, int width, int rows, std::ptrdiff_t stride,
                                float* cells) {
    using F = Pack<Target>;
    for (int r = 0; r < rows; ++r, distances += width, cells += stride)
      for (int k = 0; k < width; k += F::lanes)
        min(F::load(distances + k), F::load(cells + k)).store(cells + k);
  }
};

}  // namespace

ClearanceMap::ClearanceMap(const ClearanceMapOptions& options)
    : options_(options),
      geometry_(detail::geometry_of(options, "clearance_map")),
      cells_(geometry_.rows, geometry_.columns),
      kernel_reach_(saturate_cast<int>(std::ceil(options.reach / options.resolution))) {
  geometry_.center_x = options.center_x;
  geometry_.center_y = options.center_y;
  const int width = 2 * kernel_reach_ + 1;
  kernel_width_ = padded(width);
  kernel_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(kernel_width_),
                 static_cast<float>(options.reach));
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < width; ++j) {
      kernel_[i * kernel_width_ + j] =
          static_cast<float>(options.resolution * std::hypot(i - kernel_reach_, j - kernel_reach_));
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
  // Also false for values that are not finite.
  if (!(u > -n && u < geometry_.rows + n && v > -n && v < geometry_.columns + n)) return;
  const int row = saturate_cast<int>(std::floor(u)), column = saturate_cast<int>(std::floor(v));
  const bool inside = row >= 0 && column >= 0 && row < geometry_.rows && column < geometry_.columns;
  if (inside && *cells_.at(row, column) == 0) return;  // neighbouring beams often hit the same cell
  const int begin = std::max(column - n, 0), end = std::min(column + n + 1, geometry_.columns);
  const int row_begin = std::max(row - n, 0), row_end = std::min(row + n + 1, geometry_.rows);
  if (end - begin == 2 * n + 1 && row_begin < row_end) {
    simd::dispatch<Lower>(kernel_.data() + (row_begin - row + n) * kernel_width_, kernel_width_,
                          row_end - row_begin, cells_.at(1, 0) - cells_.at(0, 0),
                          cells_.at(row_begin, begin));
    return;
  }
  for (int r = row_begin; r < row_end; ++r) {
    const float* kernel = kernel_.data() + (r - row + n) * kernel_width_ + (begin - column + n);
    float* cells = cells_.at(r, begin);
    for (int c = 0; c < end - begin; ++c) cells[c] = std::min(cells[c], kernel[c]);
  }
}

}  // namespace slalom::maps
