#include "slalom/maps/distance_field.hpp"

#include <algorithm>

#include "slalom/core/option_access.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::maps {
namespace {

/// Larger than any distance in cells, small enough to be counted up from.
constexpr std::int32_t far = 1 << 29;

/// The place where the parabola of (q, fq) goes below that of (v, fv), v < q. Both operands are integers
/// below 2^53, and two different results are further apart than their rounding, so that comparing with
/// integers is exact.
double intersection(std::int64_t v, std::int64_t fv, std::int64_t q, std::int64_t fq) {
  return static_cast<double>((fq + q * q) - (fv + v * v)) / static_cast<double>(2 * (q - v));
}

}  // namespace

void check_grid(const OccupancyGrid& grid) {
  const auto cells = static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
  if (grid.width < 1 || grid.height < 1 || grid.cells.size() != cells)
    throw std::invalid_argument("map: " + std::to_string(grid.cells.size()) +
                                " cells must be width x height, " + std::to_string(grid.width) + " x " +
                                std::to_string(grid.height) + ", at least one");
  if (!(grid.resolution > 0) || !std::isfinite(grid.resolution))
    throw std::invalid_argument("map: resolution " + to_text(grid.resolution) +
                                " must be finite and above 0");
  check_pose("map: origin", grid.origin);
}

void check_pose(const std::string& what, const Pose& pose) {
  if (!is_plausible(pose))
    throw std::invalid_argument(what + " (" + to_text(pose.x) + ", " + to_text(pose.y) + ", " +
                                to_text(pose.yaw) + "): " + PoseLimits::rule);
}

void check_points(const std::string& what, std::span<const Point> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_plausible(points[i]))
      check_pose(what + ": point " + std::to_string(i), {points[i].x, points[i].y, 0});
}

DistanceTransform::DistanceTransform(int width, int height) : width_(width), height_(height) {
  if (width < 1 || height < 1)
    throw std::invalid_argument("distance transform: the grid must have width x height cells, at least one");
  vertical_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  envelope_.resize(width);
}

/// Distance in cells to the nearest obstacle of the same column, by one sweep up and one down.
void DistanceTransform::measure_columns(std::span<const Occupancy> cells, bool unknown_is_obstacle) noexcept {
  const std::size_t width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  for (std::size_t i = 0; i < vertical_.size(); ++i) {
    const bool obstacle =
        cells[i] == Occupancy::occupied || (unknown_is_obstacle && cells[i] == Occupancy::unknown);
    vertical_[i] = obstacle ? 0 : far;
  }
  const auto sweep = [&](const std::int32_t* from, std::int32_t* to) {
    for (std::size_t x = 0; x < width; ++x) to[x] = std::min(to[x], from[x] + 1);
  };
  for (std::size_t y = 1; y < height; ++y) sweep(&vertical_[(y - 1) * width], &vertical_[y * width]);
  for (std::size_t y = height; y-- > 1;) sweep(&vertical_[y * width], &vertical_[(y - 1) * width]);
}

/// Builds the envelope of a row of vertical distances; returns how many parabolas it has.
int DistanceTransform::build_envelope(const std::int32_t* vertical) noexcept {
  constexpr double everywhere = -std::numeric_limits<double>::infinity();
  Parabola* const bottom = envelope_.data();
  Parabola* end = bottom;
  for (int q = 0; q < width_; ++q) {
    if (vertical[q] >= far) continue;
    const std::int64_t fq = static_cast<std::int64_t>(vertical[q]) * vertical[q];
    double start = everywhere;
    while (end != bottom) {
      start = intersection(end[-1].site, end[-1].height, q, fq);
      if (start > end[-1].start) break;
      --end;
    }
    *end = {q, fq, end == bottom ? everywhere : start};
    ++end;
  }
  return static_cast<int>(end - bottom);
}

void DistanceTransform::evaluate(int count, double resolution, double* distance) const noexcept {
  if (count == 0) {
    std::fill_n(distance, width_, std::numeric_limits<double>::infinity());
    return;
  }
  for (int k = 0, x = 0; x < width_; ++k) {
    const Parabola& here = envelope_[k];
    const double end = k + 1 < count ? envelope_[k + 1].start : width_;
    const std::int64_t site = here.site, height = here.height;
    for (; x < width_ && x <= end; ++x) {
      distance[x] = resolution * std::sqrt(static_cast<double>((x - site) * (x - site) + height));
    }
  }
}

void DistanceTransform::compute(std::span<const Occupancy> cells, bool unknown_is_obstacle, double resolution,
                                std::span<double> distance) noexcept {
  measure_columns(cells, unknown_is_obstacle);
  for (int y = 0; y < height_; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    evaluate(build_envelope(&vertical_[row]), resolution, &distance[row]);
  }
}

DistanceField distance_transform(const OccupancyGrid& grid, bool unknown_is_obstacle) {
  check_grid(grid);
  DistanceField field{grid.width, grid.height, grid.resolution, grid.origin, {}};
  field.distance.resize(grid.cells.size());
  DistanceTransform(grid.width, grid.height)
      .compute(grid.cells, unknown_is_obstacle, grid.resolution, field.distance);
  return field;
}

}  // namespace slalom::maps
