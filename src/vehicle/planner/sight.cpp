#include "vehicle/planner/sight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slalom::vehicle::detail {
namespace {

/// Returns the longest of the reading in a direction (rad, frame of the laser) and its neighbours, since a
/// point is in sight if one of them passes it: infinity if a beam hits nothing, 0 outside of the scan.
double reading(const maps::LaserScanView& scan, double bearing) noexcept {
  const double round = 2 * std::numbers::pi;
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

}  // namespace

Sight::Sight(std::span<const maps::ReferencePoint> path, bool closed, double reach,
             const PlannerOptions& options, const BodyOptions& body)
    : path_(path.begin(), path.end()),
      closed_(closed),
      limits_{CarScale::of(body)},
      reach_(reach),
      half_width_(0.5 * body.width + SensorErrors::body),
      front_(body.front),
      deceleration_(options.sight_deceleration),
      delay_(2 * options.control_period),
      laser_{options.laser_x, options.laser_y, options.laser_yaw},
      unknown_(2 * path.size()) {}

PathInSight Sight::look(const maps::LaserScanView& scan, const maps::Pose& pose, int nearest) noexcept {
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

double Sight::stopping_speed(double way) const noexcept {
  const double left = std::max(way - front_ - limits_.gap, 0.0), reaction = deceleration_ * delay_;
  return std::max(std::sqrt(reaction * reaction + 2 * deceleration_ * left) - reaction, limits_.least_speed);
}

/// Returns the point that hides a place (m, frame of the car) from the laser: none if the place is in
/// sight, the laser itself if no beam points there.
std::optional<maps::Point> Sight::hidden_by(const maps::LaserScanView& scan,
                                            const maps::Point& place) const noexcept {
  const maps::Point local = maps::inverse_transform(laser_, place);
  const double away = std::hypot(local.x, local.y), bearing = std::atan2(local.y, local.x);
  if (away < limits_.too_near) return std::nullopt;
  const double range = reading(scan, bearing);
  if (range + SensorErrors::wall >= away) return std::nullopt;
  if (range == 0) return maps::Point{laser_.x, laser_.y};
  return maps::transform(laser_, {range * std::cos(bearing), range * std::sin(bearing)});
}

/// Adds the places on both sides of a point of the path that the scan does not show.
void Sight::add_unknown(const maps::LaserScanView& scan, const maps::Pose& pose, std::size_t at) noexcept {
  const maps::ReferencePoint& point = path_[at];
  for (const double side : {-limits_.leeway, limits_.leeway}) {
    const maps::Point place = maps::inverse_transform(
        pose, {point.x - side * std::sin(point.yaw), point.y + side * std::cos(point.yaw)});
    if (hidden_by(scan, place)) unknown_[unknown_count_++] = place;
  }
}

/// Whether a place is on the path between two of its points.
bool Sight::on_path(const maps::Point& point, std::size_t from, std::size_t to) const noexcept {
  for (std::size_t i = from; i != to;) {
    if (std::hypot(path_[i].x - point.x, path_[i].y - point.y) < half_width_) return true;
    if (!advance(i)) break;
  }
  return false;
}

/// Moves to the next point of the path. Returns false at the end of an open path.
bool Sight::advance(std::size_t& at) const noexcept {
  if (!closed_ && at + 1 == path_.size()) return false;
  at = (at + 1) % path_.size();
  return true;
}

}  // namespace slalom::vehicle::detail
