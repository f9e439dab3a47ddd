#include "vehicle/course/track_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slalom::vehicle::detail {
namespace {

constexpr double border = 0.3;  // m of unknown cells around the walls

double squared_distance(maps::Point p, maps::Point a, maps::Point b) {
  const maps::Point along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  const maps::Point d = p - (a + t * along);
  return dot(d, d);
}

}  // namespace

maps::OccupancyGrid draw_map(const Curve& centre_line, const TrackGeneratorOptions& options) {
  const double half = 0.5 * options.width, reach = half + options.wall, resolution = options.resolution;
  const double inf = std::numeric_limits<double>::infinity();
  maps::Point low{inf, inf}, high{-inf, -inf};
  for (const maps::Point& p : centre_line) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const auto cells_below = [&](double v) { return std::floor((v - reach - border) / resolution); };
  const double left = cells_below(low.x), bottom = cells_below(low.y);
  maps::OccupancyGrid grid;
  grid.resolution = resolution;
  grid.origin = {left * resolution, bottom * resolution, 0};
  grid.width = saturate_cast<int>(std::ceil((high.x + reach + border) / resolution) - left);
  grid.height = saturate_cast<int>(std::ceil((high.y + reach + border) / resolution) - bottom);

  std::vector<double> squared(static_cast<std::size_t>(grid.width) * grid.height, inf);
  for (std::size_t i = 0; i < centre_line.size(); ++i) {
    const maps::Point a = centre_line[i], b = centre_line[(i + 1) % centre_line.size()];
    const auto index = [&](double v, double first) {
      return saturate_cast<int>(std::floor(v / resolution) - first);
    };
    const int x0 = index(std::min(a.x, b.x) - reach, left), x1 = index(std::max(a.x, b.x) + reach, left);
    const int y0 = index(std::min(a.y, b.y) - reach, bottom), y1 = index(std::max(a.y, b.y) + reach, bottom);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const maps::Point centre{(left + x + 0.5) * resolution, (bottom + y + 0.5) * resolution};
        double& least = squared[static_cast<std::size_t>(y) * grid.width + x];
        least = std::min(least, squared_distance(centre, a, b));
      }
  }
  grid.cells.resize(squared.size());
  for (std::size_t i = 0; i < squared.size(); ++i) {
    const double distance = std::sqrt(squared[i]);
    grid.cells[i] = distance <= half    ? maps::Occupancy::free
                    : distance <= reach ? maps::Occupancy::occupied
                                        : maps::Occupancy::unknown;
  }
  return grid;
}

}  // namespace slalom::vehicle::detail
