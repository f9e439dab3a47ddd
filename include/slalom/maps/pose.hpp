#pragma once

#include <cmath>
#include <numbers>

namespace slalom::maps {

/// A point of the plane: metres.
struct Point {
  double x = 0;  ///< m
  double y = 0;  ///< m
};

/// A pose in the plane: position in metres, yaw in radians, counter-clockwise, 0 along +x.
struct Pose {
  double x = 0;    ///< m
  double y = 0;    ///< m
  double yaw = 0;  ///< rad
};

/// The distance between two points, m.
inline double distance(const Point& a, const Point& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

/// A point given in the frame of `frame`, in the frame in which `frame` is given.
inline Point transform(const Pose& frame, const Point& point) {
  const double c = std::cos(frame.yaw), s = std::sin(frame.yaw);
  return {frame.x + c * point.x - s * point.y, frame.y + s * point.x + c * point.y};
}

/// A point given in the frame in which `frame` is given, in the frame of `frame`.
inline Point inverse_transform(const Pose& frame, const Point& point) {
  const double c = std::cos(frame.yaw), s = std::sin(frame.yaw);
  const double dx = point.x - frame.x, dy = point.y - frame.y;
  return {c * dx + s * dy, -s * dx + c * dy};
}

/// The angle shifted by whole turns into [-pi, pi].
inline double wrap_angle(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

}  // namespace slalom::maps
