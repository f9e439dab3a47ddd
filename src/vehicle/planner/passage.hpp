#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

namespace slalom::vehicle::detail {

/// The widest way along the path, past all obstacles that the map shows.
struct WidestWay {
  double margin_share = 1;  ///< share of the body's margin that fits into its narrowest place
  double soft_share = 1;    ///< share of the soft margin that fits in addition
  double top_speed = 1e3;   ///< m/s, from which the car slows down in time to what its narrow places allow
};

/// Measures the room that obstacles leave along the path. A car that keeps a wider margin than a narrow place
/// has would rather stand than pass it.
///
/// The search covers a strip along the path. The room of a way is the least clearance on it; the widest way
/// to each place follows from those to the places before it (dynamic programming).
class Passage {
 public:
  /// Takes the path, whether it is closed, and the body of the car.
  Passage(std::span<const maps::ReferencePoint> path, bool closed, const BodyOptions& body)
      : path_(path.begin(), path.end()),
        closed_(closed),
        margin_(body.margin),
        soft_margin_(body.soft_margin),
        radius_(std::hypot((body.front + body.rear) / 6, body.width / 2)) {}

  /// Searches the next `reach` m from `pose` (frame of the path); `nearest` is the point of the path nearest
  /// to it. Obstacles are those around `pose`. Ends where the map ends, and where no way is wide enough for
  /// the body: such a place is blocked, not narrow.
  WidestWay search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest,
                   double reach) noexcept {
    WidestWay way;
    auto at = static_cast<std::size_t>(nearest);
    const maps::ReferencePoint& first = path_[at];
    begin(std::cos(first.yaw) * (pose.y - first.y) - std::sin(first.yaw) * (pose.x - first.x));
    double driven = 0, since = station, narrowest = soft_end();
    while (driven < reach) {
      if (since >= station) {
        since = 0;
        const double room = advance(obstacles, pose, path_[at]);
        if (room < radius_ + least_share * margin_) break;
        narrowest = std::min(narrowest, room);
        const double slow = passing_speed(room - radius_);
        way.top_speed = std::min(way.top_speed, std::sqrt(slow * slow + 2 * braking * driven));
      }
      const std::size_t next = (at + 1) % path_.size();
      if (next == static_cast<std::size_t>(nearest) || (!closed_ && next == 0)) break;
      const double step = std::hypot(path_[next].x - path_[at].x, path_[next].y - path_[at].y);
      driven += step;
      since += step;
      at = next;
    }
    if (narrowest >= soft_end()) return way;
    const double room = narrowest - radius_;
    const double margin = std::clamp(room - leeway, least_share * margin_, margin_);
    way.margin_share = margin_ > 0 ? margin / margin_ : 1;
    way.soft_share = soft_margin_ > 0 ? std::clamp((room - margin) / soft_margin_, least_share, 1.0) : 1;
    return way;
  }

 private:
  static constexpr double lane = 0.05, widest = 1.5;  ///< m, between ways, and to the side of the path
  static constexpr int sides = static_cast<int>(widest / lane), count = 2 * sides + 1;
  static constexpr double station = 0.1;  ///< m along the path
  static constexpr int steepest = 2;  ///< ways by which a way may move sideways from one station to the next
  static constexpr double leeway = 0.06;      ///< m, to each side, that a way has to steer in
  static constexpr double least_share = 0.2;  ///< share of a margin
  static constexpr double braking = 4;        ///< m/s^2
  static constexpr double usual_room = 0.2;   ///< m around the body, from which on the speed is not limited
  static constexpr double slowest = 0.8, slope = 15;  ///< m/s; 1/s: speed per room beyond the least margin

  double soft_end() const noexcept { return radius_ + margin_ + soft_margin_; }

  /// The speed (m/s) in a place that leaves so much room (m) around the body. The map knows no more than the
  /// margins.
  double passing_speed(double room) const noexcept {
    return room < std::min(usual_room, margin_ + soft_margin_) ? slowest + slope * std::max(room - 0.03, 0.0)
                                                               : 1e3;
  }

  /// Begins with ways near this offset (m) to the left of the path.
  void begin(double offset) noexcept {
    for (int k = 0; k < count; ++k)
      rooms_[k] = std::abs((k - sides) * lane - offset) < 2 * lane ? soft_end() : -1;
  }

  /// Advances all ways to a point of the path. Returns the room (m) of the widest one.
  double advance(const maps::ClearanceMap& obstacles, const maps::Pose& pose,
                 const maps::ReferencePoint& point) noexcept {
    const std::array<double, count> before = rooms_;
    const maps::Point middle = maps::inverse_transform(pose, {point.x, point.y});
    const double yaw = point.yaw - pose.yaw, left_x = -std::sin(yaw), left_y = std::cos(yaw);
    double best = -1;
    for (int k = 0; k < count; ++k) {
      double room = -1;
      for (int from = std::max(k - steepest, 0); from <= std::min(k + steepest, count - 1); ++from)
        room = std::max(room, before[from]);
      const double offset = (k - sides) * lane;
      const double clearance =
          room < 0
              ? -1
              : static_cast<double>(obstacles.at(middle.x + offset * left_x, middle.y + offset * left_y));
      rooms_[k] = std::min(room, clearance);
      best = std::max(best, rooms_[k]);
    }
    return best;
  }

  std::vector<maps::ReferencePoint> path_;
  bool closed_;
  double margin_, soft_margin_;  ///< m
  double radius_;                ///< m, of the discs that cover the body
  std::array<double, count> rooms_{};
};

}  // namespace slalom::vehicle::detail
