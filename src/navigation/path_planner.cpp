#include "slalom/navigation/path_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::navigation {
namespace {

constexpr double cautious = 0.3;     // m beside the body's corridor in which driving costs more
constexpr float nearness_price = 4;  // times as much at its inner edge
constexpr float unknown_price = 1;   // times as much on top
constexpr double start_reach = 0.3;  // m around the start that counts as free
constexpr double kept_reach = 0.4;   // m
constexpr float other_price = 1.3F;  // times as much away from the path that was kept

maps::Point corner_of(const maps::GridGeometry& geometry) {
  return {geometry.center_x - 0.5 * geometry.length_x(), geometry.center_y - 0.5 * geometry.length_y()};
}

/// Calls `visit` with every cell (by its number in the search) within `radius` of a point.
template <class Visit>
void visit_around(const maps::GridGeometry& geometry, const maps::Point& point, double radius,
                  Visit&& visit) {
  const maps::Point corner = corner_of(geometry);
  const auto index = [&](double offset, int most) {
    return saturate_cast<int>(std::clamp(std::floor(offset / geometry.resolution), 0.0, most - 1.0));
  };
  const int first_column = index(point.x - radius - corner.x, geometry.rows),
            last_column = index(point.x + radius - corner.x, geometry.rows),
            first_row = index(point.y - radius - corner.y, geometry.columns),
            last_row = index(point.y + radius - corner.y, geometry.columns);
  for (int row = first_row; row <= last_row; ++row)
    for (int column = first_column; column <= last_column; ++column) {
      const double dx = corner.x + (column + 0.5) * geometry.resolution - point.x,
                   dy = corner.y + (row + 0.5) * geometry.resolution - point.y;
      if (dx * dx + dy * dy <= radius * radius) visit(static_cast<std::size_t>(row) * geometry.rows + column);
    }
}

}  // namespace

PathPlanner::PathPlanner(const maps::GridGeometry& geometry, double half_width)
    : half_width_(half_width),
      geometry_(geometry),
      grid_(geometry.rows, geometry.columns, geometry.resolution, max_points),
      is_kept_(grid_.size()) {}

bool PathPlanner::knows(const Costmap& costmap, const maps::Point& point) const noexcept {
  const maps::GridGeometry& geometry = costmap.geometry();
  const double margin = half_width_ + 2 * geometry.resolution;
  return std::abs(point.x - geometry.center_x) + margin < 0.5 * geometry.length_x() &&
         std::abs(point.y - geometry.center_y) + margin < 0.5 * geometry.length_y();
}

bool PathPlanner::has_room(const Costmap& costmap, const maps::Point& point) const noexcept {
  return costmap.distance(point.x, point.y) >= half_width_;
}

void PathPlanner::read(const Costmap& costmap, std::span<const maps::Pose> kept,
                       std::span<const ClosedPlace> closed) noexcept {
  geometry_ = costmap.geometry();
  grid_.set_corner(corner_of(geometry_));
  std::fill(is_kept_.begin(), is_kept_.end(), std::uint8_t{0});
  for (const maps::Pose& pose : kept)
    visit_around(geometry_, {pose.x, pose.y}, kept_reach, [&](std::size_t cell) { is_kept_[cell] = 1; });
  const GridView<1> unknown = costmap.prices();
  const std::span<float> prices = grid_.prices();
  for (std::size_t cell = 0; cell < prices.size(); ++cell) {
    const maps::Point at = grid_.centre_of(static_cast<int>(cell));
    // One cell more than `has_room` asks for, since corners are rounded.
    const double clearance = costmap.distance(at.x, at.y) - half_width_ - geometry_.resolution;
    const auto nearness = static_cast<float>(std::clamp(1 - clearance / cautious, 0.0, 1.0));
    float price = 1 + nearness_price * nearness +
                  unknown_price * look_up(unknown, static_cast<float>(at.x), static_cast<float>(at.y));
    if (!kept.empty() && !is_kept_[cell]) price *= other_price;
    prices[cell] = clearance < 0 ? 0 : price;
  }
  for (const ClosedPlace& place : closed)
    visit_around(geometry_, place.middle, place.radius, [&](std::size_t cell) { prices[cell] = 0; });
}

bool PathPlanner::search_from(const maps::Point& start) noexcept {
  const int from = grid_.cell_at(start);
  if (from < 0) return false;
  const std::span<float> prices = grid_.prices();
  visit_around(geometry_, start, start_reach, [&](std::size_t cell) {
    if (!(prices[cell] > 0)) prices[cell] = 1 + nearness_price;
  });
  grid_.spread(from);
  return true;
}

double PathPlanner::cost_to(const maps::Point& point) const noexcept {
  const int cell = grid_.cell_at(point);
  return cell < 0 ? std::numeric_limits<double>::infinity() : grid_.cost(cell);
}

std::span<const maps::Point> PathPlanner::path_to(const maps::Point& point) noexcept {
  return grid_.path_to(grid_.cell_at(point), spacing);
}

std::vector<maps::Pose> plan_path(const Costmap& costmap, const Footprint& footprint, const maps::Pose& start,
                                  const maps::Pose& goal) {
  PathPlanner planner(costmap.geometry(), footprint.half_width());
  planner.read(costmap, {}, {});
  std::vector<maps::Pose> path;
  if (!planner.search_from({start.x, start.y}) || !std::isfinite(planner.cost_to({goal.x, goal.y})))
    return path;
  for (const maps::Point& point : planner.path_to({goal.x, goal.y})) path.push_back({point.x, point.y, 0});
  path.push_back(goal);
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    path[i].yaw = std::atan2(path[i + 1].y - path[i].y, path[i + 1].x - path[i].x);
  return path;
}

}  // namespace slalom::navigation
