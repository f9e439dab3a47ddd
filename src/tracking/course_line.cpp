#include "tracking/course_line.hpp"

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/reference_path.hpp"

namespace slalom::tracking {
namespace {

constexpr double spacing = 0.1;        // m, about
constexpr double most_steps = 1e6;     // steps of a course
constexpr double curvature_arm = 0.5;  // m, over which yaws are compared

double distance(const maps::ReferencePoint& a, const maps::ReferencePoint& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

}  // namespace

CourseLine::CourseLine(std::span<const maps::ReferencePoint> points) {
  maps::check_reference_path(points);
  const std::size_t n = points.size();
  double longest = 0, last = distance(points.back(), points.front());
  for (std::size_t i = 0; i + 1 < n; ++i) longest = std::max(longest, distance(points[i], points[i + 1]));
  closed_ = last <= 3 * longest;
  std::vector<double> arcs{0};
  for (std::size_t i = 0; i + 1 < n + closed_; ++i)
    arcs.push_back(arcs.back() + distance(points[i], points[(i + 1) % n]));
  length_ = arcs.back();
  const std::size_t count = std::max<std::size_t>(slalom::count(length_, spacing, most_steps, "course"), 3);
  step_ = length_ / (closed_ ? count : count - 1);
  std::size_t i = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double arc = k * step_;
    while (i + 2 < arcs.size() && arcs[i + 1] < arc) ++i;
    const maps::ReferencePoint &a = points[i], &b = points[(i + 1) % n];
    const double t = std::clamp((arc - arcs[i]) / std::max(arcs[i + 1] - arcs[i], 1e-9), 0.0, 1.0);
    points_.push_back(
        {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), 0, 0, a.speed + t * (b.speed - a.speed)});
  }
  // Yaws and curvatures from the points themselves: the yaws of a path may be anything.
  const auto arm = saturate_cast<std::size_t>(std::clamp(curvature_arm / step_, 1.0, 1e3));
  const auto neighbour = [&](std::size_t k, std::size_t ahead, bool backwards) {
    if (closed_) return backwards ? (k + count - ahead % count) % count : (k + ahead) % count;
    return backwards ? k - std::min(k, ahead) : std::min(k + ahead, count - 1);
  };
  const auto yaw_between = [&](std::size_t from, std::size_t to) {
    return std::atan2(points_[to].y - points_[from].y, points_[to].x - points_[from].x);
  };
  for (std::size_t k = 0; k < count; ++k) {
    points_[k].yaw = yaw_between(neighbour(k, 1, true), neighbour(k, 1, false));
    const std::size_t before = neighbour(k, arm, true), after = neighbour(k, arm, false);
    if (before == k || after == k) continue;  // an end of an open course
    points_[k].curvature = maps::wrap_angle(yaw_between(k, after) - yaw_between(before, k)) / (arm * step_);
  }
}

CourseLine::Point CourseLine::at(double arc) const noexcept {
  const std::size_t count = points_.size();
  double place = arc / step_;
  if (closed_) {
    place -= std::floor(place / count) * count;
  } else {
    place = std::clamp(place, 0.0, static_cast<double>(count - 1));
  }
  const std::size_t i = std::min(saturate_cast<std::size_t>(place), count - 1);
  const Point &a = points_[i], &b = points_[closed_ ? (i + 1) % count : std::min(i + 1, count - 1)];
  const double t = place - i;
  const auto mix = [t](double from, double to) { return from + t * (to - from); };
  return {mix(a.x, b.x), mix(a.y, b.y), a.yaw + t * maps::wrap_angle(b.yaw - a.yaw),
          mix(a.curvature, b.curvature), mix(a.speed, b.speed)};
}

CourseLine::Place CourseLine::project(const maps::Pose& car) const noexcept {
  const auto squared_to = [&](std::size_t k) {
    const double dx = car.x - points_[k].x, dy = car.y - points_[k].y;
    return dx * dx + dy * dy;
  };
  const auto turned = [&](std::size_t k) { return car.yaw - points_[k].yaw; };
  const std::size_t nearest = maps::place_on_path(points_.size(), squared_to, turned, points_.size());
  const Point& point = points_[nearest];
  const double c = std::cos(point.yaw), s = std::sin(point.yaw);
  const double dx = car.x - point.x, dy = car.y - point.y;
  const double along = std::clamp(dx * c + dy * s, -step_, step_);
  double arc = nearest * step_ + along;
  arc = closed_ ? arc - std::floor(arc / length_) * length_ : std::clamp(arc, 0.0, length_);
  const Point there = at(arc);
  return {arc, (car.y - there.y) * std::cos(there.yaw) - (car.x - there.x) * std::sin(there.yaw)};
}

double CourseLine::between(double from, double to) const noexcept {
  return closed_ ? std::remainder(to - from, length_) : to - from;
}

}  // namespace slalom::tracking
