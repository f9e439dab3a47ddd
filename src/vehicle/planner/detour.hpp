#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/grid_search.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "vehicle/planner/recovery.hpp"

namespace slalom::vehicle::detail {

/// Finds a path around an obstacle on the course, by a search in the map of obstacles. A plan looks only one
/// horizon ahead, so a dead end beside the obstacle can look better to it than the open side.
///
/// The search covers a grid around the car (maps::GridSearch). The car is a disc of its width and margin, and
/// cells near obstacles cost more. The search ends at the furthest point of the course in the grid that can
/// be reached; from there the path follows the course. After construction nothing allocates.
class Detour {
 public:
  /// Takes the course, whether it is closed, and the body of the car.
  Detour(std::span<const maps::ReferencePoint> course, bool closed, const BodyOptions& body)
      : course_(course.begin(), course.end()),
        closed_(closed),
        front_(body.front),
        needed_(0.5 * body.width + body.margin),
        grid_(columns, rows, cell_size, max_points),
        field_(any_path(), field_options()) {
    grid_.set_corner({first_x, first_y});
    path_.reserve(max_points);
  }

  /// Notes the state of the recovery and the pose of the car (frame of the course). Call it once per control
  /// period. A place where the car had to reverse on a detour counts as a dead end in later searches, until
  /// the car is past it.
  void note(const Recovery& recovery, const maps::Pose& pose) noexcept {
    if (recovery.reversing() && on_detour_) {
      if (dead_end_count_ == dead_ends_.size()) dead_end_count_ = 0;
      dead_ends_[dead_end_count_++] = maps::transform(pose, {front_, 0});
    }
    on_detour_ = recovery.tries_again();
    if (!on_detour_ && !recovery.reversing()) dead_end_count_ = 0;
  }

  /// Searches from `pose` (frame of the course) in the map of obstacles around it. `nearest` is the point of
  /// the course nearest to the car. Returns whether there is a path.
  bool search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest) noexcept {
    set_prices(obstacles, pose);
    grid_.spread(grid_.cell_at({0, 0}));
    const int end = furthest_reached(pose, nearest);
    if (end < 0 && dead_end_count_ > 0) {  // all ways were tried; try them again
      dead_end_count_ = 0;
      return search(obstacles, pose, nearest);
    }
    if (end < 0) return false;
    const maps::ReferencePoint& goal = course_[end];
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

  /// The path of the last search that found one, with speeds of at most 1.5 m/s.
  std::span<const maps::ReferencePoint> path() const noexcept { return path_; }
  /// Computes the field of the path around a position (m).
  void update_field(const maps::Point& position) noexcept { field_.update(position); }
  /// The field of the path, as of the last `update_field`.
  const maps::ReferenceField& field() const noexcept { return field_; }

 private:
  static constexpr double cell_size = 0.1;             ///< m
  static constexpr int columns = 80, rows = 80;        ///< cells along the car's x and y
  static constexpr double first_x = -2, first_y = -4;  ///< m, robot's frame, corner of the grid
  static constexpr double speed_limit = 1.5;           ///< m/s on the detour
  static constexpr double cautious = 0.2;              ///< m beside the car's corridor that cost more
  static constexpr double nearness_price = 4;          ///< extra price at its inner edge
  static constexpr double start_reach = 0.5;           ///< m around the car that counts as free
  static constexpr double spacing = 0.1;               ///< m between points
  static constexpr double min_path_length = 3;         ///< m along the course to the end
  static constexpr double dead_end_radius = 0.4;       ///< m
  static constexpr std::size_t max_points = 240;       ///< points of the path
  static constexpr double map_length = 14;             ///< m, of the field

  static maps::ReferenceFieldOptions field_options() {
    maps::ReferenceFieldOptions options;
    options.length_x = options.length_y = map_length;
    options.points = static_cast<int>(max_points);
    options.points_behind = 10;
    options.spacing = 0;
    return options;
  }

  /// Returns a path for the construction of the field, until there is a detour.
  static std::vector<maps::ReferencePoint> any_path() {
    std::vector<maps::ReferencePoint> path(max_points);
    for (std::size_t i = 0; i < path.size(); ++i)
      path[i] = {spacing * static_cast<double>(i), 0, 0, speed_limit};
    return path;
  }

  /// Sets the price of each cell; 0 where the car cannot be.
  void set_prices(const maps::ClearanceMap& obstacles, const maps::Pose& pose) noexcept {
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

  /// Returns the index of the furthest point of the course that the search has reached before the course
  /// leaves the grid; -1 if there is none.
  int furthest_reached(const maps::Pose& pose, int nearest) const noexcept {
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
  void follow_course(int from) noexcept {
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

  /// The number of points of the course from this one on.
  std::size_t points_from(std::size_t first) const noexcept {
    return closed_ ? course_.size() : course_.size() - first;
  }

  std::vector<maps::ReferencePoint> course_;
  bool closed_;
  double front_;   ///< m, from the pose to the car's front
  double needed_;  ///< m, from the car's middle to an obstacle
  maps::GridSearch grid_;
  ReservedVector<maps::ReferencePoint> path_;
  maps::ReferenceField field_;
  std::array<maps::Point, 4> dead_ends_{};
  std::size_t dead_end_count_ = 0;
  bool on_detour_ = false;  ///< the car followed the path in the last control period
};

}  // namespace slalom::vehicle::detail
