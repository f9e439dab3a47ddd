#include "slalom/navigation/costmap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace slalom::navigation {

namespace {

/// Half of the diagonal of a cell, in edges of a cell.
constexpr double half_diagonal = 0.70710678118654752;

int checked_size(int cells, const char* name) {
  if (cells >= 3 && cells <= 20000) return cells;
  throw std::invalid_argument("costmap." + std::string(name) + ": " + std::to_string(cells) +
                              ": must be 3 to 20000 cells");
}

double checked_resolution(double resolution) {
  if (resolution >= 0.001 && resolution <= 10) return resolution;
  std::ostringstream text;
  text << "costmap.resolution: " << resolution << ": must be in [0.001, 10] m";
  throw std::invalid_argument(text.str());
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
      geometry_{checked_size(width, "width"), checked_size(height, "height"), checked_resolution(resolution),
                0, 0},
      transform_(width, height),
      transformed_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      distances_(width, height),
      prices_(width, height) {
  const bool priced = unknown == UnknownCells::priced;
  distances_.fill({priced ? reach : 0.0F});
  prices_.fill({priced ? 1.0F : 0.0F});
}

bool Costmap::update(const maps::OccupancyGrid& grid) noexcept {
  if (grid.width != geometry_.rows || grid.height != geometry_.columns ||
      grid.resolution != geometry_.resolution || grid.cells.size() != transformed_.size())
    return false;
  if (!std::isfinite(grid.origin.x) || !std::isfinite(grid.origin.y) || grid.origin.yaw != 0) return false;
  geometry_.center_x = grid.origin.x + 0.5 * geometry_.length_x();
  geometry_.center_y = grid.origin.y + 0.5 * geometry_.length_y();
  transform_.compute(grid.cells, unknown_ == UnknownCells::obstacle, grid.resolution, transformed_);
  // Rows of the cells run against x, columns against y; the grid is stored along x, then along y.
  const int width = grid.width, height = grid.height;
  for (int row = 0; row < width; ++row) {
    float *distance = distances_.at(row, 0), *price = prices_.at(row, 0);
    std::size_t from = static_cast<std::size_t>(width) * static_cast<std::size_t>(height - 1) +
                       static_cast<std::size_t>(width - 1 - row);
    for (int column = 0; column < height; ++column, from -= static_cast<std::size_t>(width)) {
      distance[column] = std::min(static_cast<float>(transformed_[from]), reach);
      if (unknown_ == UnknownCells::obstacle) {  // and so is the space off the grid
        const int to_edge = std::min(std::min(row + 1, width - row), std::min(column + 1, height - column));
        distance[column] = std::min(distance[column], static_cast<float>(to_edge * grid.resolution));
      }
      price[column] =
          unknown_ == UnknownCells::priced && grid.cells[from] == maps::Occupancy::unknown ? 1.0F : 0.0F;
    }
  }
  return true;
}

double Costmap::distance(double x, double y) const noexcept {
  return static_cast<double>(*distances_.at(geometry_.row(x), geometry_.column(y)));
}

bool Costmap::collides(const Footprint& footprint, const maps::Pose& pose) const noexcept {
  const double slack = 2 * half_diagonal * geometry_.resolution;  // error of the positions in both cells
  if (distance(pose.x, pose.y) >= footprint.circumscribed_radius() + slack) return false;
  std::array<maps::Point, Footprint::max_vertices> corners;
  const std::span<const maps::Point> vertices = footprint.vertices();
  maps::Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  maps::Point high{-low.x, -low.y};
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    corners[i] = maps::transform(pose, vertices[i]);
    low = {std::min(low.x, corners[i].x), std::min(low.y, corners[i].y)};
    high = {std::max(high.x, corners[i].x), std::max(high.y, corners[i].y)};
  }
  const auto index = [&](double first, double position) {
    return static_cast<int>(std::floor((first - position) / geometry_.resolution + 0.5));
  };
  const double first_x = geometry_.cell_x(0), first_y = geometry_.cell_y(0);
  const int row_begin = index(first_x, high.x), row_end = index(first_x, low.x) + 1;
  const int column_begin = index(first_y, high.y), column_end = index(first_y, low.y) + 1;
  for (int row = row_begin; row < row_end; ++row)
    for (int column = column_begin; column < column_end; ++column) {
      const bool inside = row >= 0 && column >= 0 && row < geometry_.rows && column < geometry_.columns;
      if (inside ? !is_obstacle(row, column) : unknown_ != UnknownCells::obstacle) continue;
      const maps::Point middle{geometry_.cell_x(row), geometry_.cell_y(column)};
      for (std::size_t i = 0; i < vertices.size(); ++i)
        if (enters_square(corners[i], corners[(i + 1) % vertices.size()], middle, geometry_.resolution / 2))
          return true;
      if (footprint.contains(maps::inverse_transform(pose, middle))) return true;
    }
  return false;
}

}  // namespace slalom::navigation
