#include "slalom/navigation/scan_map.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::navigation {
namespace {

/// Calls `visit` with column and row of the cell at a position, if there is one.
template <class Visit>
void visit_cell(const maps::OccupancyGrid& grid, const maps::Point& at, Visit&& visit) {
  const int column = saturate_cast<int>(std::floor((at.x - grid.origin.x) / grid.resolution), -1),
            row = saturate_cast<int>(std::floor((at.y - grid.origin.y) / grid.resolution), -1);
  if (grid.contains(column, row)) visit(column, row);
}

}  // namespace

ScanMap::ScanMap(maps::OccupancyGrid known) : known_(std::move(known)), seen_(known_) {
  maps::check_grid(known_);
  if (known_.origin.yaw != 0) throw std::invalid_argument("scan map: the map must not be turned");
}

void ScanMap::add(const RangeScan& scan) noexcept {
  if (!maps::is_plausible(scan.pose)) return;
  const std::size_t count = scan.ranges.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double range = scan.ranges[i];
    if (!(range > 0 && std::isfinite(range))) continue;
    const double angle = scan.pose.yaw + maps::beam_angle(i, count);
    const double cosine = std::cos(angle), sine = std::sin(angle);
    const bool hit = range < scan.max_range;
    // The last cell but one is left as it is: noise moves the end of a beam from cell to cell.
    clear({scan.pose.x, scan.pose.y}, cosine, sine, hit ? range - 1.5 * known_.resolution : scan.max_range);
    if (!hit) continue;
    visit_cell(seen_, {scan.pose.x + range * cosine, scan.pose.y + range * sine},
               [&](int column, int row) { seen_.at(column, row) = maps::Occupancy::occupied; });
  }
}

/// Sets the cells along a beam free, or occupied where the map has a wall.
void ScanMap::clear(const maps::Point& from, double cosine, double sine, double range) noexcept {
  const double step = 0.5 * known_.resolution, along = known_.width * step, across = known_.height * step;
  const maps::Point middle{known_.origin.x + along, known_.origin.y + across};
  // The part of the beam that can be on the map.
  const double away = maps::distance(from, middle), half = std::hypot(along, across) + step;
  const double last = std::min(range, away + half) / step;
  for (double k = std::max(std::floor((away - half) / step), 0.0); k <= last; ++k)
    visit_cell(seen_, {from.x + k * step * cosine, from.y + k * step * sine}, [&](int column, int row) {
      const bool is_wall = known_.at(column, row) == maps::Occupancy::occupied;
      seen_.at(column, row) = is_wall ? maps::Occupancy::occupied : maps::Occupancy::free;
    });
}

}  // namespace slalom::navigation
