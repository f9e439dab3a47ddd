#include "slalom/navigation/costmap.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/options.hpp"
#include "slalom/maps/pose_limits.hpp"

namespace slalom::navigation {
namespace {

constexpr float most_expensive = 1e6F;  // price of a cell, at most

maps::GridGeometry checked(int width, int height, double resolution) {
  slalom::detail::check("costmap", {"width", "cells", "", 3, 20000}, width);
  slalom::detail::check("costmap", {"height", "cells", "", 3, 20000}, height);
  slalom::detail::check("costmap", {"resolution", "m", "", 0.001, 10}, resolution);
  return {width, height, resolution, 0, 0};
}

/// Whether the segment from a to b has a point inside the square of half edge `half` around `middle` (Liang
/// and Barsky, ACM Transactions on Graphics 3, 1984).
bool enters_square(const maps::Point& a, const maps::Point& b, const maps::Point& middle, double half) {
  double enter = 0, leave = 1;
  const auto clip = [&](double start, double step) {
    if (step == 0) return std::abs(start) < half;
    const double t0 = (-half - start) / step, t1 = (half - start) / step;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
    return enter < leave;
  };
  return clip(a.x - middle.x, b.x - a.x) && clip(a.y - middle.y, b.y - a.y);
}

}  // namespace

Costmap::Costmap(int width, int height, double resolution, UnknownCells unknown)
    : unknown_(unknown),
      geometry_(checked(width, height, resolution)),
      transform_(width, height),
      transformed_(static_cast<std::size_t>(width) * height),
      distances_(width, height),
      prices_(width, height) {
  const bool priced = unknown == UnknownCells::priced;
  distances_.fill({priced ? reach : 0.0F});
  prices_.fill({priced ? 1.0F : 0.0F});
}

bool Costmap::update(const maps::OccupancyGrid& grid, std::span<const float> prices) noexcept {
  if (grid.width != geometry_.rows || grid.height != geometry_.columns ||
      grid.resolution != geometry_.resolution || grid.cells.size() != transformed_.size() ||
      (!prices.empty() && prices.size() != transformed_.size()))
    return false;
  if (!maps::is_plausible(grid.origin) || grid.origin.yaw != 0) return false;
  geometry_.center_x = grid.origin.x + 0.5 * geometry_.length_x();
  geometry_.center_y = grid.origin.y + 0.5 * geometry_.length_y();
  transform_.compute(grid.cells, unknown_ == UnknownCells::obstacle, grid.resolution, transformed_);
  // Rows of the cells run against x, columns against y; the grid is stored along x, then along y.
  const int width = grid.width, height = grid.height;
  for (int row = 0; row < width; ++row) {
    float *distance = distances_.at(row, 0), *price = prices_.at(row, 0);
    std::size_t from = static_cast<std::size_t>(width) * height - 1 - row;
    for (int column = 0; column < height; ++column, from -= width) {
      distance[column] = std::min(static_cast<float>(transformed_[from]), reach);
      if (unknown_ == UnknownCells::obstacle) {  // and so is the space off the grid
        const int to_edge = std::min(std::min(row + 1, width - row), std::min(column + 1, height - column));
        distance[column] = std::min(distance[column], static_cast<float>(to_edge * grid.resolution));
      }
      price[column] =
          unknown_ == UnknownCells::priced && grid.cells[from] == maps::Occupancy::unknown ? 1.0F : 0.0F;
      if (!prices.empty() && prices[from] > 0) price[column] += std::min(prices[from], most_expensive);
    }
  }
  return true;
}

double Costmap::distance(double x, double y) const noexcept {
  return *distances_.at(geometry_.row(x), geometry_.column(y));
}

/// Whether the body overlaps an obstacle cell at `to`, or a vertex enters one on its straight way from
/// `from`.
bool Costmap::touches(const Footprint& footprint, const maps::Pose& from,
                      const maps::Pose& to) const noexcept {
  struct Segment {
    maps::Point begin, end;
  };
  std::array<Segment, 2 * Footprint::max_vertices> segments;
  const std::span<const maps::Point> vertices = footprint.vertices();
  const std::size_t n = vertices.size();
  maps::Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  maps::Point high{-low.x, -low.y};
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point before = maps::transform(from, vertices[i]), here = maps::transform(to, vertices[i]);
    segments[i].begin = segments[(i + n - 1) % n].end = here;
    segments[n + i] = {before, here};
    low = {std::min({low.x, here.x, before.x}), std::min({low.y, here.y, before.y})};
    high = {std::max({high.x, here.x, before.x}), std::max({high.y, here.y, before.y})};
  }
  // Space off the grid is an obstacle, or free.
  const double first_x = geometry_.cell_x(0), first_y = geometry_.cell_y(0);
  const auto cells = [&](double first, double position) {
    return (first - position) / geometry_.resolution + 0.5;
  };
  const int row_begin = saturate_cast<int>(std::floor(cells(first_x, high.x))),
            row_last = saturate_cast<int>(std::ceil(cells(first_x, low.x)) - 1),
            column_begin = saturate_cast<int>(std::floor(cells(first_y, high.y))),
            column_last = saturate_cast<int>(std::ceil(cells(first_y, low.y)) - 1);
  if (unknown_ == UnknownCells::obstacle &&
      (row_begin < 0 || column_begin < 0 || row_last >= geometry_.rows || column_last >= geometry_.columns))
    return true;
  for (int row = std::max(row_begin, 0); row <= std::min(row_last, geometry_.rows - 1); ++row)
    for (int column = std::max(column_begin, 0), next; column <= std::min(column_last, geometry_.columns - 1);
         column = next) {
      const double away = *distances_.at(row, column) / geometry_.resolution - 1e-3;  // cells, rounded
      next = column + std::max(saturate_cast<int>(std::ceil(away)), 1);
      if (away > 0) continue;
      const maps::Point middle{geometry_.cell_x(row), geometry_.cell_y(column)};
      for (std::size_t i = 0; i < 2 * n; ++i)
        if (enters_square(segments[i].begin, segments[i].end, middle, geometry_.resolution / 2)) return true;
      if (footprint.contains(maps::inverse_transform(to, middle))) return true;
    }
  return false;
}

bool Costmap::collides(const Footprint& footprint, const maps::Pose& from,
                       const maps::Pose& to) const noexcept {
  if (!maps::is_plausible(from) || !maps::is_plausible(to)) return true;
  const double slack = std::numbers::sqrt2 * geometry_.resolution;  // error of the positions in both cells
  const double turn = maps::wrap_angle(to.yaw - from.yaw), way = std::hypot(to.x - from.x, to.y - from.y);
  const maps::Point middle{0.5 * (from.x + to.x), 0.5 * (from.y + to.y)};
  if (distance(middle.x, middle.y) >= footprint.circumscribed_radius() + 0.5 * way + slack) return false;
  // In each part a vertex moves by at most a cell.
  const double longest = way + footprint.circumscribed_radius() * std::abs(turn);
  const int parts = std::max(saturate_cast<int>(std::ceil(longest / geometry_.resolution)), 1);
  maps::Pose before = from;
  for (int k = 1; k <= parts; ++k) {
    const double share = static_cast<double>(k) / parts;
    const maps::Pose here{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y),
                          from.yaw + share * turn};
    if (touches(footprint, before, here)) return true;
    before = here;
  }
  return false;
}

}  // namespace slalom::navigation
