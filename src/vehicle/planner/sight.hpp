#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "slalom/vehicle/planner/planner_options.hpp"

namespace slalom::vehicle::detail {

/// The part of the path ahead that a scan shows.
struct PathInSight {
  static constexpr double all = std::numeric_limits<double>::infinity();
  double way = all;       ///< m along the path, to the first place that an obstacle beside the path hides
  double obstacle = all;  ///< m along the path, to the first obstacle on it
};

/// Computes how far the path ahead is in sight. A car that cannot stop within this distance cannot avoid an
/// obstacle behind the next corner.
class Sight {
 public:
  /// Looks along this path, up to `reach` (m) ahead. The options give the pose of the laser. An obstacle that
  /// the body of the car would touch counts as on the path.
  Sight(std::span<const maps::ReferencePoint> path, bool closed, double reach, const PlannerOptions& options,
        const BodyOptions& body)
      : path_(path.begin(), path.end()),
        closed_(closed),
        reach_(reach),
        half_width_(0.5 * body.width + hit_error),
        front_(body.front),
        delay_(2 * options.control_period),
        laser_{options.laser_x, options.laser_y, options.laser_yaw},
        unknown_(2 * path.size()) {}

  /// Looks from a pose in the frame of the path; `nearest` is the point of the path nearest to it. A beam
  /// without a reading shows everything. Obstacles on the path hide nothing, since a plan that passes them
  /// sees the path behind them in time.
  PathInSight look(const maps::LaserScanView& scan, const maps::Pose& pose, int nearest) noexcept {
    PathInSight seen;
    unknown_count_ = 0;
    if (scan.ranges.empty() || scan.angle_increment == 0) return seen;
    const auto first = static_cast<std::size_t>(nearest);
    std::size_t next = first;
    for (double way = 0; way < reach_;) {
      const std::size_t before = next;
      if (!advance(next) || next == first) break;
      way += std::hypot(path_[next].x - path_[before].x, path_[next].y - path_[before].y);
      if (seen.way < PathInSight::all) {
        add_unknown(scan, pose, next);
        continue;
      }
      const auto hit = hidden_by(scan, maps::inverse_transform(pose, {path_[next].x, path_[next].y}));
      if (!hit) continue;
      const bool beside_scan = hit->x == laser_.x && hit->y == laser_.y;
      if (!beside_scan && on_path(maps::transform(pose, *hit), first, next)) {
        seen.obstacle = std::min(seen.obstacle, way);
      } else {
        seen.way = way;
      }
    }
    return seen;
  }

  /// Points (m, frame of the car) beside the hidden part of the path that are hidden, too. Only the path
  /// itself is known to be free there: a car that leaves it for a shorter way may meet a wall.
  std::span<const maps::Point> unknown() const noexcept { return {unknown_.data(), unknown_count_}; }

  /// The highest speed (m/s, > 0) at which the car stops within `way` (m) with this deceleration (m/s^2).
  double stopping_speed(double way, double deceleration) const noexcept {
    const double left = std::max(way - front_ - gap, 0.0), reaction = deceleration * delay_;
    return std::max(std::sqrt(reaction * reaction + 2 * deceleration * left) - reaction, least_speed);
  }

 private:
  static constexpr double too_near = 0.4;      ///< m from the laser; nearer places count as seen
  static constexpr double leeway = 0.45;       ///< m; how far beside the path the car may drive unseen
  static constexpr double range_error = 0.15;  ///< m, error of a reading of a wall at a small angle
  static constexpr double hit_error = 0.03;    ///< m, error of a reading of a body
  static constexpr double gap = 0.1;           ///< m, from the car to what it stops before
  static constexpr double least_speed = 1;     ///< m/s: at this speed a car sees around any corner in time

  /// Returns the longest of the reading in a direction (rad, frame of the laser) and its neighbours, since a
  /// point is in sight if one of them passes it: infinity if a beam hits nothing, 0 outside of the scan.
  static double reading(const maps::LaserScanView& scan, double bearing) noexcept {
    constexpr double round = 2 * std::numbers::pi;
    double turn = std::fmod(bearing - scan.angle_min, round);
    if (turn * scan.angle_increment < 0) turn += std::copysign(round, scan.angle_increment);
    const double beam = std::round(turn / scan.angle_increment);
    const auto count = static_cast<double>(scan.ranges.size());
    if (!(beam >= 0 && beam < count)) return 0;
    double longest = 0;
    for (double k = std::max(beam - 1, 0.0); k <= std::min(beam + 1, count - 1); ++k) {
      const double range = scan.ranges[static_cast<std::size_t>(k)];
      if (!(range >= scan.range_min && range < scan.range_max)) return PathInSight::all;
      longest = std::max(longest, range);
    }
    return longest;
  }

  /// Returns the point that hides a place (m, frame of the car) from the laser: none if the place is in
  /// sight, the laser itself if no beam points there.
  std::optional<maps::Point> hidden_by(const maps::LaserScanView& scan,
                                       const maps::Point& place) const noexcept {
    const maps::Point local = maps::inverse_transform(laser_, place);
    const double away = std::hypot(local.x, local.y), bearing = std::atan2(local.y, local.x);
    if (away < too_near) return std::nullopt;
    const double range = reading(scan, bearing);
    if (range + range_error >= away) return std::nullopt;
    if (range == 0) return maps::Point{laser_.x, laser_.y};
    return maps::transform(laser_, {range * std::cos(bearing), range * std::sin(bearing)});
  }

  /// Adds the places on both sides of a point of the path that the scan does not show.
  void add_unknown(const maps::LaserScanView& scan, const maps::Pose& pose, std::size_t at) noexcept {
    const maps::ReferencePoint& point = path_[at];
    for (const double side : {-leeway, leeway}) {
      const maps::Point place = maps::inverse_transform(
          pose, {point.x - side * std::sin(point.yaw), point.y + side * std::cos(point.yaw)});
      if (hidden_by(scan, place)) unknown_[unknown_count_++] = place;
    }
  }

  /// Whether a place is on the path between two of its points.
  bool on_path(const maps::Point& point, std::size_t from, std::size_t to) const noexcept {
    for (std::size_t i = from; i != to;) {
      if (std::hypot(path_[i].x - point.x, path_[i].y - point.y) < half_width_) return true;
      if (!advance(i)) break;
    }
    return false;
  }

  /// Moves to the next point of the path. Returns false at the end of an open path.
  bool advance(std::size_t& at) const noexcept {
    if (!closed_ && at + 1 == path_.size()) return false;
    at = (at + 1) % path_.size();
    return true;
  }

  std::vector<maps::ReferencePoint> path_;
  bool closed_;
  double reach_, half_width_;  ///< m
  double front_, delay_;       ///< m, s
  maps::Pose laser_;
  std::vector<maps::Point> unknown_;
  std::size_t unknown_count_ = 0;
};

}  // namespace slalom::vehicle::detail
