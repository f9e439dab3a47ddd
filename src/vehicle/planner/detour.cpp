#include "vehicle/planner/detour.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {
namespace {

constexpr int cells = 80;                // along either side of the grid
constexpr double spacing = 0.1;          // m between points and side of a cell, of a 1/10-scale car
constexpr std::size_t max_points = 240;  // points of the path

maps::ReferenceFieldOptions field_options(double scale) {
  maps::ReferenceFieldOptions options{.length_x = 14 * scale, .length_y = 14 * scale};
  options.resolution *= scale;
  options.points = static_cast<int>(max_points);
  options.points_behind = 10;
  options.spacing = 0;
  return options;
}

/// Returns a path for the construction of the field, until there is a detour.
std::vector<maps::ReferencePoint> any_path() {
  std::vector<maps::ReferencePoint> path(max_points);
  for (std::size_t i = 0; i < path.size(); ++i) path[i] = {spacing * static_cast<double>(i), 0, 0, 1};
  return path;
}

}  // namespace

Detour::Detour(std::span<const maps::ReferencePoint> course, bool closed, const BodyOptions& body)
    : course_(course.begin(), course.end()),
      closed_(closed),
      front_(body.front),
      needed_(0.5 * body.width + body.margin),
      scale_(CarScale::of(body)),
      speed_limit_(1.5 * scale_.speed),
      grid_(cells, cells, spacing * scale_.length, max_points),
      field_(any_path(), field_options(scale_.length)) {
  grid_.set_corner({-2 * scale_.length, -0.5 * cells * spacing * scale_.length});
  path_.reserve(max_points);
}

void Detour::note(const maps::Recovery& recovery, const maps::Pose& pose) noexcept {
  const double radius = 0.4 * scale_.length;  // m, of a dead end
  if (recovery.reverses() && on_detour_)
    dead_ends_.add_dead_end({maps::transform(pose, {front_, 0}), radius});
  on_detour_ = recovery.retries();
  if (!on_detour_ && !recovery.reverses()) dead_ends_.forget_dead_ends();
}

bool Detour::search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest) noexcept {
  set_prices(obstacles, pose);
  grid_.spread(grid_.cell_at({0, 0}));
  const int end = furthest_reached(pose, nearest);
  if (end < 0 && dead_ends_.has_dead_ends()) {  // all ways were tried; try them again
    dead_ends_.forget_dead_ends();
    return search(obstacles, pose, nearest);
  }
  if (end < 0) return false;
  const maps::ReferencePoint& goal = course_[end];
  path_.clear();
  for (const maps::Point& point : grid_.path_to(
           grid_.cell_at(maps::inverse_transform(pose, {goal.x, goal.y})), spacing * scale_.length)) {
    const maps::Point moved = maps::transform(pose, point);
    path_.push_back({moved.x, moved.y, 0, speed_limit_});
  }
  if (path_.empty()) return false;
  follow_course(end);
  return field_.set_path(path_);
}

/// Sets the price of each cell; 0 where the car cannot be, but for the place where it is.
void Detour::set_prices(const maps::ClearanceMap& obstacles, const maps::Pose& pose) noexcept {
  const double cautious = 0.2 * scale_.length, start_reach = 0.5 * scale_.length;  // m
  grid_.set_prices([&](const maps::Point& at) { return obstacles.at(at.x, at.y) - needed_; }, cautious);
  grid_.open_around({0, 0}, start_reach);
  for (const maps::ClosedDisc& place : dead_ends_.all())
    grid_.close({maps::inverse_transform(pose, place.middle), place.radius});
}

/// Returns the index of the furthest point of the course that the search has reached before the course leaves
/// the grid; -1 if there is none.
int Detour::furthest_reached(const maps::Pose& pose, int nearest) const noexcept {
  const double least_way = 3 * scale_.length;  // m along the course to the end
  std::size_t at = static_cast<std::size_t>(nearest);
  const std::size_t count = points_from(at);
  int furthest = -1;
  double way = 0;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const std::size_t next = (at + 1) % course_.size();
    way += std::hypot(course_[next].x - course_[at].x, course_[next].y - course_[at].y);
    at = next;
    if (way < least_way) continue;
    const int cell = grid_.cell_at(maps::inverse_transform(pose, {course_[at].x, course_[at].y}));
    if (cell < 0) break;
    if (grid_.reached(cell)) furthest = static_cast<int>(at);
  }
  return furthest;
}

/// Continues the path along the course from this point on.
void Detour::follow_course(int from) noexcept {
  const auto first = static_cast<std::size_t>(from);
  const std::size_t count = points_from(first);
  for (std::size_t k = 0; k < count && path_.size() < max_points; ++k) {
    const maps::ReferencePoint& next = course_[(first + k) % course_.size()];
    if (std::hypot(next.x - path_.back().x, next.y - path_.back().y) < spacing * scale_.length) continue;
    path_.push_back({next.x, next.y, 0, std::min(next.speed, speed_limit_)});
  }
  for (std::size_t i = 0; i + 1 < path_.size(); ++i)
    path_[i].yaw = std::atan2(path_[i + 1].y - path_[i].y, path_[i + 1].x - path_[i].x);
  if (path_.size() > 1) path_.back().yaw = path_[path_.size() - 2].yaw;
}

}  // namespace slalom::vehicle::detail
