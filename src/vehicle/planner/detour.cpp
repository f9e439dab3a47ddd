#include "vehicle/planner/detour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slalom::vehicle::detail {

namespace {

constexpr double cell_size = 0.1;               // m
constexpr int columns = 80, rows = 80;          // along the car's x and y
constexpr double first_x = -2, first_y = -4;    // m, robot's frame, corner of the grid
constexpr double speed_limit = 1.5;             // m/s on the detour
constexpr double cautious = 0.2;                // m beyond what the car needs, in which driving costs more
constexpr double nearness_price = 4;            // times as much at the inner end of it
constexpr double start_reach = 0.5;             // m around the car that counts as free
constexpr double spacing = 0.1, least_way = 3;  // m between points, and along the course to the end
constexpr double dead_end_radius = 0.4;         // m
constexpr std::size_t most_points = 240;
constexpr double map_length = 14;                         // m
constexpr int smoothing_reach = 3, smoothing_rounds = 2;  // points

constexpr float unreached = std::numeric_limits<float>::infinity();

maps::ReferenceFieldOptions field_options() {
  maps::ReferenceFieldOptions options;
  options.length_x = options.length_y = map_length;
  options.points = static_cast<int>(most_points);
  options.points_behind = 10;
  options.spacing = 0;
  return options;
}

/// A path to construct the field with, before there is one.
std::vector<maps::ReferencePoint> any_path() {
  std::vector<maps::ReferencePoint> path(most_points);
  for (std::size_t i = 0; i < path.size(); ++i)
    path[i] = {spacing * static_cast<double>(i), 0, 0, speed_limit};
  return path;
}

}  // namespace

Detour::Detour(std::span<const maps::ReferencePoint> course, const BodyOptions& body)
    : course_(course.begin(), course.end()),
      front_(body.front),
      needed_(0.5 * body.width + body.margin),
      prices_(rows * columns),
      costs_(prices_.size()),
      previous_(prices_.size()),
      field_(any_path(), field_options()) {
  queue_.reserve(8 * prices_.size());
  corners_.reserve(prices_.size());
  path_.reserve(most_points);
  smoothed_.reserve(most_points);
}

maps::Point Detour::centre_of(int cell) const noexcept {
  return {first_x + (cell % columns + 0.5) * cell_size, first_y + (cell / columns + 0.5) * cell_size};
}

int Detour::cell_at(const maps::Point& point) const noexcept {
  const double column = std::floor((point.x - first_x) / cell_size),
               row = std::floor((point.y - first_y) / cell_size);
  if (!(column >= 0 && column < columns && row >= 0 && row < rows)) return -1;
  return static_cast<int>(row) * columns + static_cast<int>(column);
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
  for (std::size_t i = 0; i < prices_.size(); ++i) {
    const maps::Point at = centre_of(static_cast<int>(i));
    const double clearance = obstacles.at(at.x, at.y) - needed_;
    const double nearness = std::clamp(1 - clearance / cautious, 0.0, 1.0);
    prices_[i] = static_cast<float>(1 + nearness_price * nearness);
    if (clearance < 0 && std::hypot(at.x, at.y) > start_reach) prices_[i] = 0;
  }
  for (std::size_t k = 0; k < dead_end_count_; ++k) {
    const maps::Point dead_end = maps::inverse_transform(pose, dead_ends_[k]);
    for (std::size_t i = 0; i < prices_.size(); ++i) {
      const maps::Point at = centre_of(static_cast<int>(i));
      if (std::hypot(at.x - dead_end.x, at.y - dead_end.y) < dead_end_radius) prices_[i] = 0;
    }
  }
}

/// Computes costs_ and previous_ of every cell that can be reached.
void Detour::spread(int from) noexcept {
  std::fill(costs_.begin(), costs_.end(), unreached);
  queue_.assign(1, {0, from});
  costs_[static_cast<std::size_t>(from)] = 0;
  previous_[static_cast<std::size_t>(from)] = -1;
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Reached here = queue_.back();
    queue_.pop_back();
    if (here.cost > costs_[static_cast<std::size_t>(here.cell)]) continue;
    const int column = here.cell % columns, row = here.cell / columns;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = column + dx, y = row + dy;
        if ((dx == 0 && dy == 0) || x < 0 || x >= columns || y < 0 || y >= rows) continue;
        const auto next = static_cast<std::size_t>(y * columns + x);
        if (!(prices_[next] > 0)) continue;
        const float step = static_cast<float>(cell_size) * (dx != 0 && dy != 0 ? 1.41421356f : 1.0f);
        const float cost = here.cost + step * prices_[next];
        if (cost >= costs_[next]) continue;
        costs_[next] = cost;
        previous_[next] = here.cell;
        queue_.push_back({cost, static_cast<int>(next)});
        std::push_heap(queue_.begin(), queue_.end());
      }
  }
}

/// Whether the straight line between two cells costs no more than the least price but for what the first one
/// costs: it may go along an obstacle, but not towards it.
bool Detour::is_clear(int from, int to) const noexcept {
  const maps::Point a = centre_of(from), b = centre_of(to);
  const float most = std::max(prices_[static_cast<std::size_t>(from)], prices_[static_cast<std::size_t>(to)]);
  const int steps = static_cast<int>(std::ceil(std::hypot(b.x - a.x, b.y - a.y) / (0.5 * cell_size)));
  for (int i = 1; i < steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const int cell = cell_at({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)});
    const float price = cell < 0 ? 0 : prices_[static_cast<std::size_t>(cell)];
    if (!(price > 0) || price > most) return false;
  }
  return true;
}

/// The points of the cheapest path to `goal`, in the robot's frame, from the car on: straight from corner to
/// corner.
void Detour::follow_back(int goal) noexcept {
  corners_.clear();
  for (int cell = goal; cell >= 0; cell = previous_[static_cast<std::size_t>(cell)]) corners_.push_back(cell);
  std::reverse(corners_.begin(), corners_.end());
  path_.clear();
  for (std::size_t at = 0; at + 1 < corners_.size() && path_.size() < most_points;) {
    std::size_t next = at + 1;
    while (next + 1 < corners_.size() && is_clear(corners_[at], corners_[next + 1])) ++next;
    const maps::Point a = centre_of(corners_[at]), b = centre_of(corners_[next]);
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const int parts = std::max(1, static_cast<int>(std::round(length / spacing)));
    for (int i = 0; i < parts && path_.size() < most_points; ++i) {
      const double share = static_cast<double>(i) / parts;
      path_.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), 0, speed_limit});
    }
    at = next;
  }
}

/// Rounds the corners, by moving averages.
void Detour::smooth() noexcept {
  const int count = static_cast<int>(path_.size());
  for (int round = 0; round < smoothing_rounds; ++round) {
    smoothed_.assign(path_.begin(), path_.end());
    for (int i = 1; i + 1 < count; ++i) {
      const int reach = std::min({smoothing_reach, i, count - 1 - i});
      maps::Point sum{0, 0};
      for (int k = i - reach; k <= i + reach; ++k) {
        sum.x += path_[static_cast<std::size_t>(k)].x;
        sum.y += path_[static_cast<std::size_t>(k)].y;
      }
      smoothed_[static_cast<std::size_t>(i)].x = sum.x / (2 * reach + 1);
      smoothed_[static_cast<std::size_t>(i)].y = sum.y / (2 * reach + 1);
    }
    path_.swap(smoothed_);
  }
}

/// The furthest point of the course that is reached before the course leaves the grid, as an index; -1 if
/// there is none.
int Detour::furthest_reached(const maps::Pose& pose, int nearest) const noexcept {
  const std::size_t count = course_.size();
  std::size_t at = static_cast<std::size_t>(nearest);
  int furthest = -1;
  double way = 0;
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const std::size_t next = (at + 1) % count;
    way += std::hypot(course_[next].x - course_[at].x, course_[next].y - course_[at].y);
    at = next;
    if (way < least_way) continue;
    const int cell = cell_at(maps::inverse_transform(pose, {course_[at].x, course_[at].y}));
    if (cell < 0) break;
    if (costs_[static_cast<std::size_t>(cell)] < unreached) furthest = static_cast<int>(at);
  }
  return furthest;
}

/// Continues the path along the course from this point on.
void Detour::follow_course(int from) noexcept {
  const std::size_t count = course_.size();
  for (std::size_t k = 0; k < count && path_.size() < most_points; ++k) {
    const maps::ReferencePoint& next = course_[(static_cast<std::size_t>(from) + k) % count];
    if (std::hypot(next.x - path_.back().x, next.y - path_.back().y) < spacing) continue;
    path_.push_back({next.x, next.y, 0, std::min(next.speed, speed_limit)});
  }
  for (std::size_t i = 0; i + 1 < path_.size(); ++i)
    path_[i].yaw = std::atan2(path_[i + 1].y - path_[i].y, path_[i + 1].x - path_[i].x);
  if (path_.size() > 1) path_.back().yaw = path_[path_.size() - 2].yaw;
}

bool Detour::search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest) noexcept {
  set_prices(obstacles, pose);
  spread(cell_at({0, 0}));
  const int end = furthest_reached(pose, nearest);
  if (end < 0 && dead_end_count_ > 0) {  // all ways were tried: again from the first
    dead_end_count_ = 0;
    return search(obstacles, pose, nearest);
  }
  if (end < 0) return false;
  const maps::ReferencePoint& goal = course_[static_cast<std::size_t>(end)];
  follow_back(cell_at(maps::inverse_transform(pose, {goal.x, goal.y})));
  smooth();
  for (maps::ReferencePoint& point : path_) {
    const maps::Point moved = maps::transform(pose, {point.x, point.y});
    point.x = moved.x;
    point.y = moved.y;
  }
  if (path_.empty()) return false;
  follow_course(end);
  return field_.set_path(path_);
}

const maps::ReferenceField& Detour::field_around(const maps::Point& position) noexcept {
  field_.update(position);
  return field_;
}

}  // namespace slalom::vehicle::detail
