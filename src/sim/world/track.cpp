#include "slalom/sim/track.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/options.hpp"

namespace slalom::sim {

Track::Track(maps::OccupancyGrid grid, std::optional<LapPath> lap_path, bool outside_is_wall)
    : grid_(std::move(grid)), outside_is_wall_(outside_is_wall), lap_path_(std::move(lap_path)) {
  using slalom::detail::check;
  check("map", {"width", "cells", "", 1, 32766}, grid_.width);
  check("map", {"height", "cells", "", 1, 32766}, grid_.height);
  maps::check_grid(grid_);
  if (std::all_of(grid_.cells.begin(), grid_.cells.end(),
                  [](maps::Occupancy cell) { return cell == maps::Occupancy::occupied; }))
    throw std::invalid_argument("map: must have a free cell");
  cosine_ = std::cos(grid_.origin.yaw);
  sine_ = std::sin(grid_.origin.yaw);
  distance_ = maps::distance_transform(grid_, false);
  make_clearance();
}

void Track::make_clearance() {
  // A wall is its whole cell, not the cell's centre, and a beam may start anywhere in a cell: between the
  // outlines of two cells lies one cell less along each axis than between their centres. That is the distance
  // to the set of walls grown by one cell each way.
  const int width = grid_.width + 2, height = grid_.height + 2;
  maps::OccupancyGrid grown{width, height, 1, {}, {}};
  grown.cells.assign(static_cast<std::size_t>(width) * height, maps::Occupancy::free);
  const auto outside = [&](int c, int r) { return c < 0 || r < 0 || c >= grid_.width || r >= grid_.height; };
  const auto stops = [&](int c, int r) {
    return outside(c, r) || grid_.at(c, r) == maps::Occupancy::occupied;
  };
  for (int r = -1; r <= grid_.height; ++r)
    for (int c = -1; c <= grid_.width; ++c) {
      if (!stops(c, r)) continue;
      for (int y = std::max(r, 0); y <= std::min(r + 2, height - 1); ++y)
        for (int x = std::max(c, 0); x <= std::min(c + 2, width - 1); ++x)
          grown.at(x, y) = maps::Occupancy::occupied;
    }
  const maps::DistanceField field = maps::distance_transform(grown, false);
  // One more, since look-ups of 16 bits may read 32.
  clearance_.resize(field.distance.size() + 1);
  for (int r = -1; r <= grid_.height; ++r)
    for (int c = -1; c <= grid_.width; ++c) {
      const auto i = static_cast<std::size_t>(r + 1) * width + c + 1;
      const double cells = std::min(field.distance[i], 500.0);
      clearance_[i] = saturate_cast<std::int16_t>(cells * clearance_scale);
      if (outside(c, r) && !outside_is_wall_)
        clearance_[i] = exit;
      else if (stops(c, r))
        clearance_[i] = wall;
    }
}

bool Track::in_wall(const maps::Point& point) const noexcept {
  const maps::Point cell = to_cells(point);
  if (!contains(cell)) return outside_is_wall_;
  return clearance_at(saturate_cast<int>(cell.x), saturate_cast<int>(cell.y)) == wall;
}

double Track::distance_to_wall(const maps::Point& point) const noexcept {
  const maps::Point cell = to_cells(point);
  if (!contains(cell)) return outside_is_wall_ ? 0 : std::numeric_limits<double>::infinity();
  double nearest = distance_.at(saturate_cast<int>(cell.x), saturate_cast<int>(cell.y));
  if (outside_is_wall_)
    nearest = std::min(nearest, grid_.resolution * std::min(std::min(cell.x, grid_.width - cell.x),
                                                            std::min(cell.y, grid_.height - cell.y)));
  return nearest;
}

bool Track::collides_with_wall(const Box& box) const noexcept {
  const maps::Point middle = to_cells({box.pose.x, box.pose.y});
  const double l = box.length / 2 / grid_.resolution, w = box.width / 2 / grid_.resolution;
  if (contains(middle)) {
    const int free = clearance_at(saturate_cast<int>(middle.x), saturate_cast<int>(middle.y));
    if (free > 0 && static_cast<double>(free) / clearance_scale > std::hypot(l, w)) return false;
  }
  const double yaw = box.pose.yaw - grid_.origin.yaw, c = std::cos(yaw), s = std::sin(yaw);
  const double reach_x = l * std::abs(c) + w * std::abs(s), reach_y = l * std::abs(s) + w * std::abs(c);
  if (outside_is_wall_ && !(middle.x - reach_x > 0 && middle.y - reach_y > 0 &&
                            middle.x + reach_x < grid_.width && middle.y + reach_y < grid_.height))
    return true;
  const int left = saturate_cast<int>(std::max(0.0, std::floor(middle.x - reach_x)));
  const int right = saturate_cast<int>(std::min(grid_.width - 1.0, std::floor(middle.x + reach_x)));
  const int bottom = saturate_cast<int>(std::max(0.0, std::floor(middle.y - reach_y)));
  const int top = saturate_cast<int>(std::min(grid_.height - 1.0, std::floor(middle.y + reach_y)));
  // The cells' own axes are settled by the loops' limits; a cell reaches `half` along the box's axes.
  const double half = (std::abs(c) + std::abs(s)) / 2;
  for (int row = bottom; row <= top; ++row)
    for (int column = left; column <= right; ++column) {
      if (clearance_at(column, row) != wall) continue;
      const double dx = column + 0.5 - middle.x, dy = row + 0.5 - middle.y;
      if (std::abs(c * dx + s * dy) <= l + half && std::abs(c * dy - s * dx) <= w + half) return true;
    }
  return false;
}

}  // namespace slalom::sim
