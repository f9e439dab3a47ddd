#include "vehicle/planner/passage.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {
namespace {

constexpr double lane = 0.05;        // m between ways, of a 1/10-scale car
constexpr double least_share = 0.2;  // share of a margin

}  // namespace

Passage::Passage(std::span<const maps::ReferencePoint> path, bool closed, const BodyOptions& body)
    : path_(path.begin(), path.end()),
      closed_(closed),
      body_(body),
      scale_(CarScale::of(body)),
      radius_(std::hypot((body.front + body.rear) / 6, body.width / 2)) {}

WidestWay Passage::search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest,
                          double reach) noexcept {
  constexpr double braking = 4;  // m/s^2
  const double station = 0.1 * scale_.length,
               leeway = 0.06 * scale_.length;  // m along the path; m to each side, to steer in
  WidestWay way;
  auto at = static_cast<std::size_t>(nearest);
  const maps::ReferencePoint& first = path_[at];
  begin(std::cos(first.yaw) * (pose.y - first.y) - std::sin(first.yaw) * (pose.x - first.x));
  double driven = 0, since = station, narrowest = soft_end();
  while (driven < reach) {
    if (since >= station) {
      since = 0;
      const double room = advance(obstacles, pose, path_[at]);
      if (room < radius_ + least_share * body_.margin) break;
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
  const double margin = std::clamp(room - leeway, least_share * body_.margin, body_.margin);
  way.margin_share = body_.margin > 0 ? margin / body_.margin : 1;
  way.soft_share =
      body_.soft_margin > 0 ? std::clamp((room - margin) / body_.soft_margin, least_share, 1.0) : 1;
  return way;
}

/// The speed (m/s) where so much room (m) is left around the body. The map knows no more than the margins.
double Passage::passing_speed(double room) const noexcept {
  const double root = scale_.speed;
  return room < std::min(0.2 * scale_.length, body_.margin + body_.soft_margin)
             ? 0.8 * root + 15 / root * std::max(room - 0.03 * scale_.length, 0.0)
             : 1e3;
}

/// Begins with ways near this offset (m) to the left of the path.
void Passage::begin(double offset) noexcept {
  for (int k = 0; k < count; ++k)
    rooms_[k] =
        std::abs((k - sides) * lane * scale_.length - offset) < 2 * lane * scale_.length ? soft_end() : -1;
}

/// Advances all ways to a point of the path. Returns the room (m) of the widest one.
double Passage::advance(const maps::ClearanceMap& obstacles, const maps::Pose& pose,
                        const maps::ReferencePoint& point) noexcept {
  constexpr int steepest = 2;  // ways by which a way may move sideways from one station to the next
  const std::array<double, count> before = rooms_;
  const maps::Point middle = maps::inverse_transform(pose, {point.x, point.y});
  const double yaw = point.yaw - pose.yaw, left_x = -std::sin(yaw), left_y = std::cos(yaw);
  double best = -1;
  for (int k = 0; k < count; ++k) {
    double room = -1;
    for (int from = std::max(k - steepest, 0); from <= std::min(k + steepest, count - 1); ++from)
      room = std::max(room, before[from]);
    const double offset = (k - sides) * lane * scale_.length;
    const double clearance =
        room < 0 ? -1
                 : static_cast<double>(obstacles.at(middle.x + offset * left_x, middle.y + offset * left_y));
    rooms_[k] = std::min(room, clearance);
    best = std::max(best, rooms_[k]);
  }
  return best;
}

}  // namespace slalom::vehicle::detail
