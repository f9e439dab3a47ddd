#include "vehicle/planner/detour.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {

namespace {

constexpr double cell_size = 0.1;             // m
constexpr int columns = 80, rows = 80;        // along the car's x and y
constexpr double first_x = -2, first_y = -4;  // m, robot's frame, corner of the grid
constexpr double speed_limit = 1.5;           // m/s on the detour
constexpr double cautious = 0.2;              // m beside the car's corridor in which driving costs more
constexpr double nearness_price = 4;          // extra price at its inner edge
constexpr double start_reach = 0.5;           // m around the car that counts as free
constexpr double spacing = 0.1, min_path_length = 3;  // m between points, and along the course to the end
constexpr double dead_end_radius = 0.4;               // m
constexpr std::size_t max_points = 240;
constexpr double map_length = 14;  // m

maps::ReferenceFieldOptions field_options() {
  maps::ReferenceFieldOptions options;
  options.length_x = options.length_y = map_length;
  options.points = static_cast<int>(max_points);
  options.points_behind = 10;
  options.spacing = 0;
  return options;
}

/// A path for the construction of the field, until there is a detour.
std::vector<maps::ReferencePoint> any_path() {
  std::vector<maps::ReferencePoint> path(max_points);
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i] = {spacing * static_cast<double>(i), 0, 0, speed_limit};
  return path;
}

}  // namespace

Detour::Detour(std::span<const maps::ReferencePoint> course, bool closed, const BodyOptions& body)
    : course_(course.begin(), course.end()),
      closed_(closed),
      front_(body.front),
      needed_(0.5 * body.width + body.margin),
      grid_(columns, rows, cell_size, max_points),
      field_(any_path(), field_options()) {
  grid_.set_corner({first_x, first_y});
  path_.reserve(max_points);
}

void Detour::note(const Recovery& recovery, const maps::Pose& pose) noexcept {
  if (recovery.reversing() && on_detour_) {
    if (dead_end_count_ == dead_ends_.size()) dead_end_count_ = 0;
    dead_ends_[dead_end_count_++] = maps::transform(pose, {front_, 0});
  }
  on_detour_ = recovery.tries_again();
  if (!on_detour_ && !recovery.reversing()) dead_end_count_ = 0;
}

void Detour::set_prices(const maps::ClearanceMap& obstacles, const maps::Pose& pose) noexcept {
  const std::span<float> prices = grid_.prices();
  for (std::size_t i = 0; i < prices.size(); ++i) {
    const maps::Point at = grid_.centre_of(static_cast<int>(i));
    const double clearance = obstacles.at(at.x, at.y) - needed_;
    const double nearness = std::clamp(1 - clearance / cautious, 0.0, 1.0);
    prices[i] = static_cast<float>(1 + nearness_price * nearness);
    if (clearance < 0 && std::hypot(at.x, at.y) > start_reach) prices[i] = 0;
  }
  for (std::size_t k = 0; k < dead_end_count_; ++k) {
    const maps::Point dead_end = maps::inverse_transform(pose, dead_ends_[k]);
    for (std::size_t i = 0; i < prices.size(); ++i) {
      const maps::Point at = grid_.centre_of(static_cast<int>(i));
      if (std::hypot(at.x - dead_end.x, at.y - dead_end.y) < dead_end_radius) prices[i] = 0;
    }
  }
}

/// Returns the index of the furthest point of the course that the search has reached before the course leaves
/// the grid; -1 if there is none.
int Detour::furthest_reached(const maps::Pose& pose, int nearest) const noexcept {
  std::size_t at = static_cast<std::size_t>(nearest);
  const std::size_t count = points_from(at);
  int furthest = -1;
  double way = 0;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const std::size_t next = (at + 1) % course_.size();
    way += std::hypot(course_[next].x - course_[at].x, course_[next].y - course_[at].y);
    at = next;
    if (way < min_path_length) continue;
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
    if (std::hypot(next.x - path_.back().x, next.y - path_.back().y) < spacing) continue;
    path_.push_back({next.x, next.y, 0, std::min(next.speed, speed_limit)});
  }
  for (std::size_t i = 0; i + 1 < path_.size(); ++i)
    path_[i].yaw = std::atan2(path_[i + 1].y - path_[i].y, path_[i + 1].x - path_[i].x);
  if (path_.size() > 1) path_.back().yaw = path_[path_.size() - 2].yaw;
}

bool Detour::search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest) noexcept {
  set_prices(obstacles, pose);
  grid_.spread(grid_.cell_at({0, 0}));
  const int end = furthest_reached(pose, nearest);
  if (end < 0 && dead_end_count_ > 0) {  // all ways were tried; try them again
    dead_end_count_ = 0;
    return search(obstacles, pose, nearest);
  }
  if (end < 0) return false;
  const maps::ReferencePoint& goal = course_[static_cast<std::size_t>(end)];
  path_.clear();
  for (const maps::Point& point :
       grid_.path_to(grid_.cell_at(maps::inverse_transform(pose, {goal.x, goal.y})), spacing)) {
    const maps::Point moved = maps::transform(pose, point);
    path_.push_back({moved.x, moved.y, 0, speed_limit});
  }
  if (path_.empty()) return false;
  follow_course(end);
  return field_.set_path(path_);
}

}  // namespace slalom::vehicle::detail
