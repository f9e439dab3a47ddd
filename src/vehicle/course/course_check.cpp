#include "slalom/vehicle/course/course_check.hpp"

#include <algorithm>
#include <cstdio>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "vehicle/racing/free_space.hpp"

namespace slalom::vehicle {
namespace {

constexpr double tolerance = 0.05;  // share above the limits of acceleration, since files are rounded

/// The points of a path, whose elements have x and y.
template <class Path>
std::vector<maps::Point> points_of(const Path& path) {
  std::vector<maps::Point> points;
  for (const auto& point : path) points.push_back({point.x, point.y});
  return points;
}

template <class Path>
void lower_speeds(Path& path, const PathGeometry& geometry, const SpeedLimits& limits) {
  std::vector<double> speeds;
  for (const auto& point : path) speeds.push_back(point.speed);
  speeds = feasible_speeds(speeds, geometry.curvature, geometry.step, geometry.closed, limits);
  for (std::size_t i = 0; i < speeds.size(); ++i) path[i].speed = speeds[i];
}

/// Collects stretches from the pieces of a course, in order.
class Stretches {
 public:
  /// The worst value of a stretch is the highest with `most`, else the lowest.
  Stretches(double length, bool most) : length_(length), most_(most) {}

  void add(double begin, double end, const maps::Point& place, double value, bool broken) {
    if (!broken) return;
    broken_ += end - begin;
    auto& stretches = found_.stretches;
    if (stretches.empty() || begin - stretches.back().end > join)
      stretches.push_back({begin, end, place, value});
    CourseStretch& stretch = stretches.back();
    stretch.end = end;
    if (most_ ? value <= stretch.value : value >= stretch.value) return;
    stretch.worst = place;
    stretch.value = value;
  }

  CourseFinding found() {
    found_.share = length_ > 0 ? std::min(1.0, broken_ / length_) : 0;
    return std::move(found_);
  }

 private:
  static constexpr double join = 1;  ///< m, stretches that are nearer to each other are one

  CourseFinding found_;
  double length_, broken_ = 0;
  bool most_;
};

void check_walls(const Course& course, const PathGeometry& path, const CourseCheckOptions& options,
                 CourseCheck& check) {
  const double needed = options.half_width + options.margin;
  Stretches stretches(course.length, false);
  check.min_distance = needed;
  const std::size_t n = course.waypoints.size(), segments = path.closed ? n : n - 1;
  double begin = 0;
  for (std::size_t i = 0; i < segments; ++i) {
    const Waypoint &a = course.waypoints[i], &b = course.waypoints[(i + 1) % n];
    const int parts = std::max(1, saturate_cast<int>(std::ceil(path.step[i] / course.map.resolution)));
    for (int k = 0; k < parts; ++k) {
      const double share = (k + 0.5) / parts, part = path.step[i] / parts;
      const maps::Point place{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
      const double distance = detail::distance_to_wall(course.map, place, needed, false);
      check.min_distance = std::min(check.min_distance, distance);
      stretches.add(begin, begin + part, place, distance, distance < needed);
      begin += part;
    }
  }
  check.walls = stretches.found();
}

void check_grip(const Course& course, const PathGeometry& path, const CourseCheckOptions& options,
                CourseCheck& check) {
  const SpeedLimits& limits = options.limits;
  Stretches stretches(course.length, true);
  const std::size_t n = course.waypoints.size(), segments = path.closed ? n : n - 1;
  double begin = 0;
  for (std::size_t i = 0; i < segments; ++i) {
    const std::size_t next = (i + 1) % n;
    const double v = course.waypoints[i].speed, after = course.waypoints[next].speed;
    const double across =
        std::max(v * v * std::abs(path.curvature[i]), after * after * std::abs(path.curvature[next]));
    const double along = (after * after - v * v) / (2 * path.step[i]);
    const double strongest = along > 0 ? limits.acceleration : limits.braking;
    const double used = std::hypot(across / limits.lateral_acceleration, along / strongest);
    const double asked = std::hypot(across, along);
    check.max_acceleration = std::max(check.max_acceleration, asked);
    stretches.add(begin, begin + path.step[i], {course.waypoints[i].x, course.waypoints[i].y}, asked,
                  used > 1 + tolerance || v > limits.top_speed);
    begin += path.step[i];
  }
  check.grip = stretches.found();
}

/// "0.11 m at (3.2, 4.0), 12.3 m to 13.1 m from the start; ...": the three worst places.
std::string places(const CourseFinding& finding, const char* unit, bool most) {
  std::vector<CourseStretch> worst = finding.stretches;
  std::stable_sort(worst.begin(), worst.end(), [&](const CourseStretch& a, const CourseStretch& b) {
    return most ? a.value > b.value : a.value < b.value;
  });
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, worst.size()); ++i) {
    char place[160];
    std::snprintf(place, sizeof place, "%s%.3g %s at (%.2f, %.2f), %.1f to %.1f m along it",
                  i > 0 ? "; " : "", worst[i].value, unit, worst[i].worst.x, worst[i].worst.y, worst[i].begin,
                  worst[i].end);
    text += place;
  }
  if (worst.size() > 3) text += "; and " + std::to_string(worst.size() - 3) + " more places";
  return text;
}

}  // namespace

CourseCheck check_course(const Course& course, const CourseCheckOptions& options) {
  const PathGeometry path = path_geometry(points_of(course.waypoints), course.closed);
  CourseCheck check;
  check_walls(course, path, options, check);
  check_grip(course, path, options, check);
  return check;
}

std::vector<std::string> sentences(const CourseCheck& check, const CourseCheckOptions& options) {
  std::vector<std::string> said;
  char text[200];
  if (!check.walls.stretches.empty()) {
    std::snprintf(
        text, sizeof text,
        "the line is nearer to a wall than %.3g m (half the car's width and its margin) on %.1f %% of "
        "its length: ",
        options.half_width + options.margin, 100 * check.walls.share);
    said.push_back(text + places(check.walls, "m", false));
  }
  if (!check.grip.stretches.empty()) {
    const SpeedLimits& limits = options.limits;
    std::snprintf(
        text, sizeof text,
        "the profile asks for more than the car can (%.3g m/s^2 across, %.3g forward, %.3g braking, "
        "%.3g m/s) on %.1f %% of its length: ",
        limits.lateral_acceleration, limits.acceleration, limits.braking, limits.top_speed,
        100 * check.grip.share);
    said.push_back(text + places(check.grip, "m/s^2", true));
  }
  return said;
}

void make_feasible(Course& course, const SpeedLimits& limits) {
  lower_speeds(course.waypoints, path_geometry(points_of(course.waypoints), course.closed), limits);
}

void make_feasible(std::vector<maps::ReferencePoint>& path, const SpeedLimits& limits) {
  lower_speeds(path, path_geometry(points_of(path)), limits);
}

}  // namespace slalom::vehicle
