#include "vehicle/racing/free_space.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"
#include "vehicle/racing/cell_regions.hpp"

namespace slalom::vehicle::detail {
namespace {

/// Makes small unknown spots free that touch no occupied cell. Returns their number.
int fill_spots(maps::OccupancyGrid& map, double largest) {
  const int most = saturate_cast<int>(largest / map.resolution);
  if (most < 1) return 0;
  const CellRegions unknown(map.width, map.height, true,
                            [&](int x, int y) { return map.at(x, y) == maps::Occupancy::unknown; });
  std::vector<char> fill(unknown.regions().size(), 0);
  for (std::size_t k = 0; k < fill.size(); ++k) {
    const CellRegion& region = unknown.regions()[k];
    fill[k] = region.right - region.left < most && region.top - region.bottom < most;
  }
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const int region = unknown.at(x, y);
      if (region < 0 || !fill[region]) continue;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (!map.contains(x + dx, y + dy) || map.at(x + dx, y + dy) == maps::Occupancy::occupied)
            fill[region] = 0;
    }
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      if (const int region = unknown.at(x, y); region >= 0 && fill[region])
        map.at(x, y) = maps::Occupancy::free;
  return static_cast<int>(std::count(fill.begin(), fill.end(), 1));
}

}  // namespace

double distance_to_wall(const maps::OccupancyGrid& map, const maps::Point& point, double reach,
                        bool unknown_is_wall) {
  const maps::Point at = maps::inverse_transform(map.origin, point);
  const double column = at.x / map.resolution, row = at.y / map.resolution;
  const double most = reach / map.resolution, cells = std::ceil(most) + 1;
  const auto on_map = [](double i, int count) { return saturate_cast<int>(std::clamp(i, 0.0, count - 1.0)); };
  double nearest = most;
  for (int y = on_map(row - cells, map.height), to = on_map(row + cells, map.height); y <= to; ++y)
    for (int x = on_map(column - cells, map.width), end = on_map(column + cells, map.width); x <= end; ++x) {
      if (map.at(x, y) == maps::Occupancy::free) continue;
      if (!unknown_is_wall && map.at(x, y) != maps::Occupancy::occupied) continue;
      const double dx = std::max({x - column, column - (x + 1), 0.0});
      const double dy = std::max({y - row, row - (y + 1), 0.0});
      if (dx < nearest && dy < nearest) nearest = std::min(nearest, std::hypot(dx, dy));
    }
  return nearest < most ? nearest * map.resolution : reach;  // the product may round to less than `reach`
}

FreeSpace::FreeSpace(const maps::OccupancyGrid& map, double spot)
    : map_(map), spots_(fill_spots(map_, spot)), field_(maps::distance_transform(map_, true)) {}

double FreeSpace::clearance(const maps::Point& point) const {
  const maps::Point at = cell(point);
  if (!on_map(at)) return -1;
  const double centre = to_centre(at);  // infinite without any wall
  return std::isfinite(centre) ? distance_to_wall(map_, point, centre + map_.resolution, true) : centre;
}

bool FreeSpace::is_clear(const maps::Point& point, double keep) const {
  const maps::Point at = cell(point);
  if (!on_map(at)) return false;
  // Half a diagonal lies between centre and corner, and as much between a point and the centre of its cell.
  const double centre = to_centre(at), doubt = 1.5 * map_.resolution;
  if (centre - doubt >= keep) return true;
  return centre + doubt >= keep && distance_to_wall(map_, point, keep + map_.resolution, true) >= keep;
}

maps::Point FreeSpace::centre(int column, int row) const {
  return maps::transform(map_.origin, {(column + 0.5) * map_.resolution, (row + 0.5) * map_.resolution});
}

maps::Point FreeSpace::cell(const maps::Point& point) const {
  const maps::Point at = maps::inverse_transform(map_.origin, point);
  return {at.x / map_.resolution - 0.5, at.y / map_.resolution - 0.5};
}

bool FreeSpace::on_map(const maps::Point& at) const {
  return at.x >= -0.5 && at.y >= -0.5 && at.x <= map_.width - 0.5 && at.y <= map_.height - 0.5;
}

double FreeSpace::to_centre(const maps::Point& at) const {
  const double left = std::floor(at.x), low = std::floor(at.y), s = at.x - left, t = at.y - low;
  const auto distance = [&](double column, double row) {
    return field_.at(std::clamp(saturate_cast<int>(column), 0, map_.width - 1),
                     std::clamp(saturate_cast<int>(row), 0, map_.height - 1));
  };
  return (1 - t) * ((1 - s) * distance(left, low) + s * distance(left + 1, low)) +
         t * ((1 - s) * distance(left, low + 1) + s * distance(left + 1, low + 1));
}

}  // namespace slalom::vehicle::detail
