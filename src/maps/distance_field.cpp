#include "slalom/maps/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace slalom::maps {
namespace {

/// Larger than any distance in cells, small enough to be counted up from.
constexpr std::int32_t far = 1 << 29;

/// The lower envelope of the parabolas (x - site)^2 + height^2 over one row.
struct Envelope {
  std::vector<std::int32_t> site;
  std::vector<std::int64_t> height;  ///< squared, cells^2
  std::vector<double> start;         ///< where the parabola becomes the lowest

  explicit Envelope(int width) : site(width), height(width), start(width) {}
};

/// Where the parabola of (q, fq) goes below that of (v, fv), v < q. Both operands are integers below 2^53,
/// and two different results are further apart than their rounding, so that comparing with integers is exact.
double intersection(std::int64_t v, std::int64_t fv, std::int64_t q, std::int64_t fq) {
  return static_cast<double>((fq + q * q) - (fv + v * v)) / static_cast<double>(2 * (q - v));
}

/// Builds the envelope of a row of vertical distances; returns how many parabolas it has.
int build(const std::int32_t* vertical, int width, Envelope& envelope) {
  int count = 0;
  for (int q = 0; q < width; ++q) {
    if (vertical[q] >= far) continue;
    const std::int64_t fq = static_cast<std::int64_t>(vertical[q]) * vertical[q];
    double start = -std::numeric_limits<double>::infinity();
    while (count > 0) {
      start = intersection(envelope.site[count - 1], envelope.height[count - 1], q, fq);
      if (start > envelope.start[count - 1]) break;
      --count;
    }
    if (count == 0) start = -std::numeric_limits<double>::infinity();
    envelope.site[count] = q;
    envelope.height[count] = fq;
    envelope.start[count] = start;
    ++count;
  }
  return count;
}

void evaluate(const Envelope& envelope, int count, int width, double resolution, double* distance) {
  if (count == 0) {
    for (int x = 0; x < width; ++x) distance[x] = std::numeric_limits<double>::infinity();
    return;
  }
  for (int k = 0, x = 0; x < width; ++k) {
    const double end = k + 1 < count ? envelope.start[k + 1] : width;
    const std::int64_t site = envelope.site[k], height = envelope.height[k];
    for (; x < width && x <= end; ++x) {
      distance[x] = resolution * std::sqrt(static_cast<double>((x - site) * (x - site) + height));
    }
  }
}

/// Distance in cells to the nearest obstacle of the same column, by one sweep up and one down.
std::vector<std::int32_t> vertical_distances(const OccupancyGrid& grid, bool unknown_is_obstacle) {
  const std::size_t width = grid.width, height = grid.height;
  std::vector<std::int32_t> vertical(width * height);
  for (std::size_t i = 0; i < vertical.size(); ++i) {
    const bool obstacle =
        grid.cells[i] == Occupancy::occupied || (unknown_is_obstacle && grid.cells[i] == Occupancy::unknown);
    vertical[i] = obstacle ? 0 : far;
  }
  const auto sweep = [&](const std::int32_t* from, std::int32_t* to) {
    for (std::size_t x = 0; x < width; ++x) to[x] = std::min(to[x], from[x] + 1);
  };
  for (std::size_t y = 1; y < height; ++y) sweep(&vertical[(y - 1) * width], &vertical[y * width]);
  for (std::size_t y = height; y-- > 1;) sweep(&vertical[y * width], &vertical[(y - 1) * width]);
  return vertical;
}

}  // namespace

DistanceField distance_transform(const OccupancyGrid& grid, bool unknown_is_obstacle) {
  if (grid.width <= 0 || grid.height <= 0 ||
      grid.cells.size() != static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height)) {
    throw std::invalid_argument("distance_transform: the grid must have width x height cells, at least one");
  }
  DistanceField field{grid.width, grid.height, grid.resolution, grid.origin, {}};
  field.distance.resize(grid.cells.size());
  const auto vertical = vertical_distances(grid, unknown_is_obstacle);
  Envelope envelope(grid.width);
  for (int y = 0; y < grid.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * grid.width;
    const int count = build(&vertical[row], grid.width, envelope);
    evaluate(envelope, count, grid.width, grid.resolution, &field.distance[row]);
  }
  return field;
}

}  // namespace slalom::maps
