// The map that is drawn of a corridor.

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/image.hpp"
#include "slalom/vehicle/racing/race_course.hpp"

namespace slalom::vehicle {
namespace {

constexpr double most_cells = 2.5e7;  // cells of a map that is drawn
constexpr double most_drawn = 3e8;    // cells that are visited to draw it

/// The size of the cells (m) of a drawn map: as given, or larger if it would have more than `most_cells`.
double drawn_resolution(double length_x, double length_y, double resolution) {
  const double side = std::max(length_x, length_y) / (maps::max_image_side - 8);
  return std::max({resolution, std::sqrt(length_x * length_y / most_cells), side});
}

/// Throws std::invalid_argument if a corridor, whose line needs a map of this size (m), is so wide for its
/// length that a map of it takes too long.
void check_work(const Corridor& corridor, double length_x, double length_y, double reach, double wall,
                double resolution) {
  const double points = static_cast<double>(corridor.centre_line.size());
  const auto takes_too_long = [&](double side) {
    const double around = 2 * (side + wall),
                 cell = drawn_resolution(length_x + around, length_y + around, resolution);
    const double cells = length(corridor) / points / cell + 2 * (side / cell + std::max(wall / cell, 2.0));
    return points * cells * cells > most_drawn;
  };
  if (!takes_too_long(reach)) return;
  double most = 0, too_much = reach;
  while (too_much - most > 0.01 * too_much) {
    const double middle = 0.5 * (most + too_much);
    (takes_too_long(middle) ? too_much : most) = middle;
  }
  throw std::invalid_argument("corridor: walls " + to_text(std::round(reach)) +
                              " m from the centre line; must be at most " + to_text(std::floor(most)) +
                              " m from it, to be drawn");
}

/// Throws std::invalid_argument if cells that became larger than `wanted` (m) cannot show a corridor.
void check_cells(const Corridor& corridor, double wanted, double resolution) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corridor.left.size(); ++i)
    narrowest = std::min(narrowest, corridor.left[i] + corridor.right[i]);
  if (resolution > wanted && narrowest < 2 * resolution)
    throw std::invalid_argument("corridor: " + to_text(narrowest) + " m wide; must be at least " +
                                to_text(std::ceil(2 * resolution)) +
                                " m, two cells of a map of 25 million cells for its length");
}

}  // namespace

maps::OccupancyGrid draw_corridor(const Corridor& corridor, double resolution, double wall) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto& line = corridor.centre_line;
  double low_x = infinity, low_y = infinity, high_x = -infinity, high_y = -infinity, reach = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    low_x = std::min(low_x, line[i].x);
    low_y = std::min(low_y, line[i].y);
    high_x = std::max(high_x, line[i].x);
    high_y = std::max(high_y, line[i].y);
    reach = std::max({reach, corridor.left[i], corridor.right[i]});
  }
  check_work(corridor, high_x - low_x, high_y - low_y, reach, wall, resolution);
  maps::OccupancyGrid map;
  map.resolution =
      drawn_resolution(high_x - low_x + 2 * (reach + wall), high_y - low_y + 2 * (reach + wall), resolution);
  wall = std::max(wall, 2 * map.resolution);
  check_cells(corridor, resolution, map.resolution);
  reach += wall;
  const auto below = [&](double value) {
    return map.resolution * std::floor((value - reach) / map.resolution - 2);
  };
  map.origin = {below(low_x), below(low_y), 0};
  const auto cells = [&](double high, double first) {
    return count(high + reach - first, map.resolution, maps::max_image_side - 2, "corridor: its map") + 2;
  };
  map.width = static_cast<int>(cells(high_x, map.origin.x));
  map.height = static_cast<int>(cells(high_y, map.origin.y));
  const std::size_t segments = corridor.closed ? line.size() : line.size() - 1;
  std::vector<double> beyond(static_cast<std::size_t>(map.width) * map.height, infinity);
  for (std::size_t i = 0; i < segments; ++i) {
    const std::size_t next = (i + 1) % line.size();
    const maps::Point a = line[i], d{line[next].x - a.x, line[next].y - a.y};
    const double square = d.x * d.x + d.y * d.y;
    const auto cell = [&](double value, double origin) {
      return saturate_cast<int>(std::floor((value - origin) / map.resolution));
    };
    const int x0 = cell(std::min(a.x, a.x + d.x) - reach, map.origin.x),
              x1 = cell(std::max(a.x, a.x + d.x) + reach, map.origin.x),
              y0 = cell(std::min(a.y, a.y + d.y) - reach, map.origin.y),
              y1 = cell(std::max(a.y, a.y + d.y) + reach, map.origin.y);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double px = map.origin.x + (x + 0.5) * map.resolution - a.x,
                     py = map.origin.y + (y + 0.5) * map.resolution - a.y;
        const double t = std::clamp((px * d.x + py * d.y) / square, 0.0, 1.0);
        const auto& widths = d.x * py - d.y * px > 0 ? corridor.left : corridor.right;
        double& least = beyond[static_cast<std::size_t>(y) * map.width + x];
        least = std::min(least,
                         std::hypot(px - t * d.x, py - t * d.y) - ((1 - t) * widths[i] + t * widths[next]));
      }
  }
  map.cells.reserve(beyond.size());
  for (const double b : beyond)
    map.cells.push_back(b <= 0      ? maps::Occupancy::free
                        : b <= wall ? maps::Occupancy::occupied
                                    : maps::Occupancy::unknown);
  return map;
}

}  // namespace slalom::vehicle
