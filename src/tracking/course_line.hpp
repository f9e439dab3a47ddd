#pragma once

#include <span>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/maps/reference_path.hpp"

namespace slalom::tracking {

/// A course as arc length and offset: points at equal distances along it, for fast look-ups.
class CourseLine {
 public:
  CourseLine() = default;  ///< no course
  /// Through at least 3 points. It is closed if its ends are not much farther apart than its points.
  explicit CourseLine(std::span<const maps::ReferencePoint> points);

  bool empty() const noexcept { return points_.empty(); }
  double length() const noexcept { return length_; }  ///< m
  bool closed() const noexcept { return closed_; }

  /// A point of the course.
  struct Point {
    double x = 0, y = 0;   ///< m
    double yaw = 0;        ///< rad
    double curvature = 0;  ///< 1/m, positive to the left
    double speed = 0;      ///< m/s
  };
  /// The point at an arc length, m; beyond the ends of an open course, the end.
  Point at(double arc) const noexcept;

  /// A position beside the course.
  struct Place {
    double arc = 0;     ///< m
    double offset = 0;  ///< m, to the left
  };
  /// The nearest place. Arc lengths of a closed course are within its length.
  Place project(const maps::Point& position) const noexcept;

  /// The way from one arc length to another, m; the shorter one of a closed course.
  double between(double from, double to) const noexcept;

 private:
  std::vector<Point> points_;
  double step_ = 0;  ///< m
  double length_ = 0;
  bool closed_ = false;
};

}  // namespace slalom::tracking
