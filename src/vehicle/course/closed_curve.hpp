#pragma once

#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::vehicle::detail {

/// Closed polygons that represent smooth closed curves. The first point follows the last one and is not
/// repeated.
using Curve = std::vector<maps::Point>;

inline maps::Point operator+(maps::Point a, maps::Point b) {
  return {a.x + b.x, a.y + b.y};
}
inline maps::Point operator-(maps::Point a, maps::Point b) {
  return {a.x - b.x, a.y - b.y};
}
inline maps::Point operator*(double s, maps::Point a) {
  return {s * a.x, s * a.y};
}
inline double dot(maps::Point a, maps::Point b) {
  return a.x * b.x + a.y * b.y;
}
inline double cross(maps::Point a, maps::Point b) {
  return a.x * b.y - a.y * b.x;
}

/// The Catmull-Rom cubic between b and c at t in [0, 1].
maps::Point catmull_rom(maps::Point a, maps::Point b, maps::Point c, maps::Point d, double t);

/// The length, m.
double length(const Curve& curve);

/// `count` points at equal steps along the curve, by Catmull-Rom cubics through its points.
Curve resampled(const Curve& curve, int count);

/// The signed curvature (1/m) at every point: of the circle through it and the points `reach` rows before and
/// after.
std::vector<double> curvature(const Curve& curve, int reach);

/// Unit normals to the left, from central differences.
Curve normals(const Curve& curve);

/// The curve convolved with a Gaussian of standard deviation `width` (m) along its length; its steps must be
/// equal.
Curve smoothed(const Curve& curve, double width);

/// The least distance (m) between points that are more than `apart` m of curve away from each other, either
/// way round.
double min_gap(const Curve& curve, double apart);

}  // namespace slalom::vehicle::detail
