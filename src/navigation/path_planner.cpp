#include "slalom/navigation/path_planner.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::navigation {
namespace {

constexpr double nearby = 1.2;  // half widths beside the corridor, around the start and a way that was kept
constexpr float other_price = 1.3F;  // times as much away from the path that was kept

}  // namespace

PathPlanner::PathPlanner(const maps::GridGeometry& geometry, double half_width, std::size_t most_points)
    : half_width_(half_width),
      geometry_(geometry),
      grid_(geometry.rows, geometry.columns, geometry.resolution, most_points),
      most_points_(most_points),
      marks_(grid_.size()) {}

bool PathPlanner::knows(const Costmap& costmap, const maps::Point& point) const noexcept {
  const maps::GridGeometry& geometry = costmap.geometry();
  const double margin = half_width_ + 2 * geometry.resolution;
  return std::abs(point.x - geometry.center_x) + margin < 0.5 * geometry.length_x() &&
         std::abs(point.y - geometry.center_y) + margin < 0.5 * geometry.length_y();
}

bool PathPlanner::has_room(const Costmap& costmap, const maps::Point& point) const noexcept {
  return costmap.distance(point.x, point.y) >= half_width_;
}

bool PathPlanner::begin(const Costmap& costmap, const maps::Point& start, std::span<const maps::Pose> kept,
                        std::span<const maps::ClosedDisc> closed, const maps::Point* towards) noexcept {
  geometry_ = costmap.geometry();
  grid_.set_corner(
      {geometry_.center_x - 0.5 * geometry_.length_x(), geometry_.center_y - 0.5 * geometry_.length_y()});
  std::fill(marks_.begin(), marks_.end(), Mark::none);
  for (const maps::Pose& pose : kept)
    grid_.visit_around({pose.x, pose.y}, nearby * half_width_,
                       [&](std::size_t cell) { marks_[cell] = kept_way; });
  for (const maps::ClosedDisc& disc : closed)
    grid_.visit_around(disc.middle, disc.radius, [&](std::size_t cell) { marks_[cell] = closed_place; });
  elsewhere_ = kept.empty() ? 1 : other_price;
  const int cell = grid_.cell_at(start);
  is_searching_ = cell >= 0;
  if (!is_searching_) return false;
  std::ranges::fill(grid_.prices(), maps::GridSearch::unpriced);
  // Cells at the start are open; from within an obstacle, as in a new zone, as far as the nearest free place.
  double reach = nearby * half_width_;
  for (bool found = false; !found && reach < geometry_.length_x() + geometry_.length_y();
       reach *= found ? 1 : 1.5)
    grid_.visit_around(start, reach, [&](std::size_t here) {
      if (grid_.prices()[here] < 0) price(costmap, static_cast<int>(here));
      found = found || grid_.prices()[here] > 0;
    });
  grid_.open_around(start, reach);
  towards ? grid_.begin(cell, *towards) : grid_.begin(cell);
  return true;
}

bool PathPlanner::advance(const Costmap& costmap, int cells) noexcept {
  is_searching_ = !grid_.advance(cells, [&](int cell) { price(costmap, cell); });
  return !is_searching_;
}

/// Sets the price of a cell that has none.
void PathPlanner::price(const Costmap& costmap, int cell) noexcept {
  // One cell more than `has_room` asks for, since corners are rounded.
  const double needed = half_width_ + geometry_.resolution;
  const maps::Point at = grid_.centre_of(cell);
  float price = maps::GridSearch::price_of(costmap.distance(at.x, at.y) - needed, nearby * half_width_);
  if (marks_[cell] == closed_place) price = 0;
  if (price > 0) price += look_up(costmap.prices(), static_cast<float>(at.x), static_cast<float>(at.y));
  grid_.prices()[cell] = marks_[cell] == none ? price * elsewhere_ : price;
}

double PathPlanner::cost_to(const maps::Point& point) const noexcept {
  const int cell = grid_.cell_at(point);
  return cell < 0 ? std::numeric_limits<double>::infinity() : grid_.cost(cell);
}

PathPlanner::Way PathPlanner::way_off(const Costmap& costmap, const maps::Point& point,
                                      double most) const noexcept {
  Way best{{}, std::numeric_limits<double>::infinity()};
  const double margin = half_width_ + 3 * geometry_.resolution;
  const double half_x = 0.5 * geometry_.length_x() - margin, half_y = 0.5 * geometry_.length_y() - margin;
  const double diagonal = std::hypot(geometry_.length_x(), geometry_.length_y());  // beyond it lies no cell
  const auto try_from = [&](double x, double y) {
    const maps::Point from{geometry_.center_x + x, geometry_.center_y + y};
    const double away = distance(from, point), cost = cost_to(from) + away;
    if (cost >= std::min(most, best.cost)) return;
    for (double along = 0; along < std::min(away, diagonal); along += geometry_.resolution) {
      const double share = along / away;
      const maps::Point here{from.x + share * (point.x - from.x), from.y + share * (point.y - from.y)};
      if (knows(costmap, here) && !has_room(costmap, here)) return;
    }
    best = {from, cost};
  };
  for (double t = -1; t < 1;
       t += 2 * geometry_.resolution / std::max({half_x, half_y, geometry_.resolution})) {
    for (const double side : {-1.0, 1.0}) {
      try_from(side * half_x, t * half_y);
      try_from(t * half_x, side * half_y);
    }
  }
  return best;
}

std::span<const maps::Point> PathPlanner::path_to(const maps::Point& point) noexcept {
  const auto way = grid_.path_to(grid_.cell_at(point), spacing);
  return way.size() < most_points_ ? way : way.first(0);
}

std::vector<maps::Pose> plan_path(const Costmap& costmap, const Footprint& footprint, const maps::Pose& start,
                                  const maps::Pose& goal) {
  const maps::GridGeometry& geometry = costmap.geometry();
  const double cells =
      static_cast<double>(geometry.rows) * geometry.columns;  // a way enters each once at most
  const double most_points = cells * (geometry.resolution / PathPlanner::spacing + 1);
  PathPlanner planner(geometry, footprint.half_width(), saturate_cast<std::size_t>(most_points) + 1);
  std::vector<maps::Pose> path;
  if (!planner.begin(costmap, {start.x, start.y})) return path;
  planner.advance(costmap);
  if (!std::isfinite(planner.cost_to({goal.x, goal.y}))) return path;
  for (const maps::Point& point : planner.path_to({goal.x, goal.y})) path.push_back({point.x, point.y, 0});
  // The last points are those of cells: straight to the goal, the path has no kink there.
  std::size_t kept = path.size();
  const auto from_goal = [&](std::size_t i) { return std::hypot(path[i].x - goal.x, path[i].y - goal.y); };
  while (kept > 1 && from_goal(kept - 1) < PathPlanner::joint) --kept;
  for (std::size_t i = kept; i < path.size(); ++i) {
    const double share = static_cast<double>(i - kept + 1) / static_cast<double>(path.size() - kept + 1);
    path[i] = {std::lerp(path[kept - 1].x, goal.x, share), std::lerp(path[kept - 1].y, goal.y, share), 0};
  }
  path.push_back(goal);
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    path[i].yaw = std::atan2(path[i + 1].y - path[i].y, path[i + 1].x - path[i].x);
  return path;
}

}  // namespace slalom::navigation
