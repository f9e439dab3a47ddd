#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/command.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

namespace slalom::vehicle::detail {

/// Finds and follows a way of slow arcs, forwards and in reverse, to a place from which the car can follow
/// its path: a turn in three points, or out of a corner.
///
/// The search is Dijkstra's over cells of position and heading, each with the pose that reached it first
/// (hybrid-state A* without a heuristic; Dolgov et al., "Path planning for autonomous vehicles in unknown
/// semi-structured environments", IJRR 29(5), 2010). It takes some milliseconds, 50 at most where there
/// is no way, and only starts while the car stands. After construction nothing allocates.
class Manoeuvre {
 public:
  /// Takes the path, whether it is closed, the body of the car, its wheelbase (m) and the largest angle of
  /// the wheels (rad).
  Manoeuvre(std::span<const maps::ReferencePoint> path, bool closed, const BodyOptions& body,
            double wheelbase, double steer_limit)
      : course_(path.begin(), path.end()),
        closed_(closed),
        wheelbase_(wheelbase),
        curvature_(usable_steering * std::tan(std::min(steer_limit, 1.2)) / wheelbase),
        radius_(std::hypot((body.front + body.rear) / 6, body.width / 2)),
        keep_(radius_ + least_share * body.margin),
        nodes_(static_cast<std::size_t>(side) * side * headings),
        costs_(nodes_.size()),
        nearest_(static_cast<std::size_t>(side) * side) {
    const double length = body.front + body.rear;
    for (int i = 0; i < 3; ++i) discs_[i] = -body.rear + length * (2 * i + 1) / 6;
    for (int i = 0; i < 6; ++i) {
      const int gear = i < 3 ? 1 : -1, turn = (i + 1) % 3 - 1;
      const double driven = gear * step, turned = turn * curvature_ * driven;
      const Direction middle = direction(0.5 * turned);
      arcs_[i] = {gear, turn, turned, driven * middle.cosine, driven * middle.sine, direction(turned)};
    }
    queue_.reserve(4 * nodes_.size());
    way_.reserve(max_steps);
    window_.reserve(max_window);
  }

  bool active() const noexcept { return active_; }
  /// Whether the car drives in reverse, or stops to do so.
  bool reverses() const noexcept { return active_ && way_[at_].gear < 0; }
  void cancel() noexcept { active_ = false; }

  /// Searches a way from `pose` (frame of the path), around which the obstacles are. `nearest` is the point
  /// of the path nearest to it. The way ends at least `ahead` m along the path from there, near the path and
  /// along it. Reversing costs more beyond `sight` (rad from the car's axis), where the laser does not look.
  /// Returns whether there is a way; then it is active.
  bool search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest, double ahead,
              double sight) noexcept {
    active_ = false;
    find_window(pose, static_cast<std::size_t>(nearest));
    std::fill(costs_.begin(), costs_.end(), std::numeric_limits<float>::infinity());
    queue_.clear();
    const double start_room = room(obstacles, 0, 0, {1, 0});
    push(index(0, 0, 0), 0, {0, 0, 0, -1, 0, 0});
    while (!queue_.empty() && queue_.size() + 6 <= queue_.capacity()) {
      std::pop_heap(queue_.begin(), queue_.end());
      const Reached here = queue_.back();
      queue_.pop_back();
      if (here.cost > costs_[here.node]) continue;
      const Node& node = nodes_[here.node];
      if (is_goal(obstacles, node, ahead)) return take(here.node, pose);
      const Direction heading = direction(node.yaw);
      for (const Arc& arc : arcs_) expand(obstacles, here, heading, arc, start_room, sight);
    }
    return false;
  }

  /// The command of the car at `pose`, around which the obstacles are, driving at `speed` (m/s) with wheels
  /// at `steer` (rad). None if the way has ended, and is no longer active; or if an obstacle is on it or the
  /// car beside it, and it still is.
  std::optional<Command> follow(const maps::ClearanceMap& obstacles, const maps::Pose& pose, double speed,
                                double steer) noexcept {
    for (;; ++at_) {
      const Step& next = way_[at_];
      if (next.gear * maps::inverse_transform(pose, {next.pose.x, next.pose.y}).x > passed) break;
      const bool is_last = at_ + 1 == way_.size();
      if (is_last) {
        active_ = false;
        return std::nullopt;
      }
      if (way_[at_ + 1].gear != next.gear && std::abs(speed) > standing) return Command{next.steer, 0};
    }
    const int gear = way_[at_].gear;
    if (std::abs(maps::inverse_transform(pose, {way_[at_].pose.x, way_[at_].pose.y}).y) > beside)
      return std::nullopt;
    double left = 0;  // m to the end of the part in this gear
    maps::Point before{pose.x, pose.y}, aim = before;
    std::size_t end = at_;
    for (; end < way_.size() && way_[end].gear == gear; ++end) {
      const maps::Pose& next = way_[end].pose;
      const maps::Point local = maps::inverse_transform(pose, {next.x, next.y});
      if (room(obstacles, local.x, local.y, direction(next.yaw - pose.yaw)) < keep_ - tolerance)
        return std::nullopt;
      if (left < look_ahead) aim = {next.x, next.y};
      left += std::hypot(next.x - before.x, next.y - before.y);
      before = {next.x, next.y};
    }
    if (end == way_.size() && gear > 0) left += 1;  // the car drives on
    const maps::Point to = maps::inverse_transform(pose, aim);
    const double square = to.x * to.x + to.y * to.y;
    const double curvature =
        square > near * near
            ? std::clamp(2 * to.y / square, -curvature_ / usable_steering, curvature_ / usable_steering)
            : std::tan(way_[at_].steer) / wheelbase_;
    for (const double driven : {0.1, 0.2}) {  // the car may be beside the way
      if (driven > left) break;               // this part of the way ends before
      const double turned = gear * driven * curvature;
      if (room(obstacles, gear * driven * std::cos(0.5 * turned), gear * driven * std::sin(0.5 * turned),
               direction(turned)) >= std::min(room(obstacles, 0, 0, {1, 0}), keep_ - tolerance))
        continue;
      if (std::abs(speed) < standing) return std::nullopt;
      return Command{std::atan(curvature * wheelbase_), 0};
    }
    // The wheels need time to turn, so the car waits for them.
    const double wanted = std::atan(curvature * wheelbase_),
                 waits = std::max(1 - 2 * std::abs(wanted - steer), 0.1);
    const double fastest =
        std::min(waits * (gear > 0 ? forwards : backwards), std::sqrt(2 * braking * left) + creep);
    return Command{wanted, gear * fastest};
  }

 private:
  static constexpr int side = 56, headings = 36;                 ///< cells
  static constexpr double cell = 0.1, half = 0.5 * side * cell;  ///< m
  static constexpr double step = 0.15;                           ///< m of an arc
  static constexpr double usable_steering = 0.85;  ///< share of the largest angle; the rest corrects
  static constexpr double least_share = 0.4;       ///< share of the margin that arcs keep
  static constexpr double cautious = 0.15;         ///< m beyond it that costs more
  static constexpr double nearness_price = 4, reverse_price = 1.5, blind_price = 8, shift_price = 0.4;
  static constexpr double goal_distance = 1.0, goal_yaw = 0.5;  ///< m from the path, rad
  static constexpr double way_out = 0.5;  ///< m in which the start's own nearness is allowed
  static constexpr std::size_t max_steps = 256, max_window = 96;
  static constexpr double window_reach = 4, window_step = 0.1;  ///< m along the path
  static constexpr double passed = 0.03, standing = 0.08, beside = 0.15, tolerance = 0.01;  ///< m, m/s, m, m
  static constexpr double look_ahead = 0.3, near = 0.1;                                     ///< m
  static constexpr double forwards = 0.8, backwards = 0.5, creep = 0.06, braking = 1.2;     ///< m/s, m/s^2

  struct Direction {
    double cosine, sine;
  };
  static Direction direction(double angle) noexcept { return {std::cos(angle), std::sin(angle)}; }
  /// A short drive; x and y (m) are its end in the frame of the rear axle at its start, `turned` is in rad.
  struct Arc {
    int gear = 0, turn = 0;
    double turned = 0, x = 0, y = 0;
    Direction turn_direction{};
  };
  /// A pose in the frame of the search, and how it was reached. The yaw is not wrapped.
  struct Node {
    float x = 0, y = 0, yaw = 0;
    std::int32_t before = -1;
    std::int8_t gear = 0, turn = 0;
  };
  struct Reached {
    float cost;
    std::int32_t node;
    bool operator<(const Reached& other) const noexcept { return cost > other.cost; }
  };
  /// A pose of the way (frame of the path), how the car drives to it, and the angle of its wheels (rad).
  struct Step {
    maps::Pose pose;
    int gear;
    double steer;
  };
  /// A point of the path in the frame of the search, and its way along the path from the nearest point, m.
  struct Place {
    maps::Pose pose;
    double way;
  };

  static int index(double x, double y, double yaw) noexcept {
    const double column = std::floor((x + half) / cell), row = std::floor((y + half) / cell);
    if (!(column >= 0 && row >= 0 && column < side && row < side)) return -1;
    const int turn = saturate_cast<int>(std::round(yaw / (2 * std::numbers::pi) * headings));
    return (saturate_cast<int>(row) * side + saturate_cast<int>(column)) * headings +
           ((turn % headings) + headings) % headings;
  }

  /// The least clearance (m) of the discs of a body at a pose in the frame of the map.
  double room(const maps::ClearanceMap& obstacles, double x, double y,
              const Direction& heading) const noexcept {
    double least = std::numeric_limits<double>::infinity();
    for (const double disc : discs_)
      least = std::min(least,
                       static_cast<double>(obstacles.at(x + disc * heading.cosine, y + disc * heading.sine)));
    return least;
  }

  /// Collects the part of the path around the car, and the place nearest to each cell.
  void find_window(const maps::Pose& pose, std::size_t nearest) noexcept {
    window_.clear();
    const auto add = [&](std::size_t i, double way) {
      const maps::ReferencePoint& point = course_[i];
      const maps::Point local = maps::inverse_transform(pose, {point.x, point.y});
      window_.push_back({{local.x, local.y, maps::wrap_angle(point.yaw - pose.yaw)}, way});
    };
    add(nearest, 0);
    for (const int direction : {1, -1}) {
      double way = 0, since = 0;
      const std::size_t most = direction > 0 ? max_window / 2 : max_window - 1;
      for (std::size_t i = nearest; way < window_reach && window_.size() < most;) {
        if (!closed_ && i == (direction > 0 ? course_.size() - 1 : 0)) break;
        const std::size_t next = (i + course_.size() + static_cast<std::size_t>(direction)) % course_.size();
        const double gap = std::hypot(course_[next].x - course_[i].x, course_[next].y - course_[i].y);
        i = next;
        way += gap;
        since += gap;
        if (since < window_step) continue;
        since = 0;
        add(i, direction * way);
      }
    }
    for (std::size_t k = 0; k < nearest_.size(); ++k) {
      const double x = (static_cast<double>(k % side) + 0.5) * cell - half,
                   y = (static_cast<double>(k / side) + 0.5) * cell - half;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t w = 0; w < window_.size(); ++w) {
        const double dx = window_[w].pose.x - x, dy = window_[w].pose.y - y, square = dx * dx + dy * dy;
        if (square < least) least = square, nearest_[k] = static_cast<std::int16_t>(w);
      }
    }
  }

  bool is_goal(const maps::ClearanceMap& obstacles, const Node& node, double ahead) const noexcept {
    if (node.gear <= 0) return false;
    const auto at = static_cast<std::size_t>(index(node.x, node.y, 0) / headings);
    const Place& place = window_[nearest_[at]];
    if (place.way < ahead || std::abs(maps::wrap_angle(node.yaw - place.pose.yaw)) > goal_yaw) return false;
    if (std::hypot(place.pose.x - node.x, place.pose.y - node.y) > goal_distance) return false;
    const Direction heading = direction(node.yaw);
    for (const double further : {0.25, 0.5})
      if (room(obstacles, node.x + further * heading.cosine, node.y + further * heading.sine, heading) <
          keep_)
        return false;
    return true;
  }

  void expand(const maps::ClearanceMap& obstacles, const Reached& from, const Direction& heading,
              const Arc& arc, double start_room, double sight) noexcept {
    const Node& node = nodes_[from.node];
    const double x = node.x + arc.x * heading.cosine - arc.y * heading.sine,
                 y = node.y + arc.x * heading.sine + arc.y * heading.cosine, yaw = node.yaw + arc.turned;
    const int to = index(x, y, yaw);
    if (to < 0) return;
    const double shift = node.gear != 0 && node.gear != arc.gear ? shift_price : 0;
    const auto cost_with = [&](double price) {
      return static_cast<float>(from.cost + step * price + shift + 0.01 * std::abs(arc.turn - node.turn));
    };
    const float least_cost = costs_[to];
    if (cost_with(arc.gear < 0 ? reverse_price : 1) >= least_cost) return;
    const Direction there = {
        heading.cosine * arc.turn_direction.cosine - heading.sine * arc.turn_direction.sine,
        heading.sine * arc.turn_direction.cosine + heading.cosine * arc.turn_direction.sine};
    const double clear = room(obstacles, x, y, there);
    if (clear < keep_ && !(clear >= start_room && from.cost < way_out && clear > 0)) return;
    double price = 1 + nearness_price * std::clamp(1 - (clear - keep_) / cautious, 0.0, 1.0);
    if (arc.gear < 0) {
      const double back_x = x + discs_[0] * there.cosine, back_y = y + discs_[0] * there.sine;
      price *= std::abs(std::atan2(back_y, back_x)) > sight ? blind_price : reverse_price;
    }
    const float cost = cost_with(price);
    if (cost >= least_cost) return;
    push(to, cost,
         {static_cast<float>(x), static_cast<float>(y), static_cast<float>(yaw), from.node,
          static_cast<std::int8_t>(arc.gear), static_cast<std::int8_t>(arc.turn)});
  }

  void push(int to, float cost, const Node& node) noexcept {
    nodes_[to] = node;
    costs_[to] = cost;
    queue_.push_back({cost, to});
    std::push_heap(queue_.begin(), queue_.end());
  }

  /// Takes the way to a node.
  bool take(std::int32_t goal, const maps::Pose& pose) noexcept {
    way_.clear();
    for (std::int32_t at = goal; nodes_[at].before >= 0;) {
      if (way_.size() == max_steps) return false;
      const Node& node = nodes_[at];
      const maps::Point place = maps::transform(pose, {node.x, node.y});
      way_.push_back({{place.x, place.y, maps::wrap_angle(pose.yaw + node.yaw)},
                      node.gear,
                      std::atan(node.turn * curvature_ * wheelbase_)});
      at = node.before;
    }
    std::reverse(way_.begin(), way_.end());
    at_ = 0;
    active_ = !way_.empty();
    return active_;
  }

  std::vector<maps::ReferencePoint> course_;
  bool closed_;
  double wheelbase_, curvature_;   ///< m, 1/m
  double radius_, keep_;           ///< m, of the discs that cover the body, and what their centres keep
  std::array<double, 3> discs_{};  ///< m, centres ahead of the rear axle
  std::array<Arc, 6> arcs_{};
  std::vector<Node> nodes_;
  std::vector<float> costs_;           ///< the least cost of each node so far; infinite before the first
  std::vector<std::int16_t> nearest_;  ///< the nearest place of `window_` for each cell of position
  ReservedVector<Reached> queue_;
  ReservedVector<Place> window_;
  ReservedVector<Step> way_;
  std::size_t at_ = 0;  ///< the step that the car drives to
  bool active_ = false;
};

}  // namespace slalom::vehicle::detail
