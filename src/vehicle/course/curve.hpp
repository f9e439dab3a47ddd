#pragma once

#include <algorithm>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::vehicle::detail {

/// A polygon that represents a smooth curve, closed unless a function is told otherwise. The first point of a
/// closed curve follows the last one and is not repeated.
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

/// An index of a curve, brought back into it: round a closed curve, to the ends of an open one.
inline std::size_t within(std::ptrdiff_t i, std::size_t count, bool closed) {
  const auto n = static_cast<std::ptrdiff_t>(count);
  return static_cast<std::size_t>(closed ? (i % n + n) % n : std::clamp<std::ptrdiff_t>(i, 0, n - 1));
}

/// The length, m.
double length(const Curve& curve, bool closed = true);

/// New points of a curve and where they are on the old one.
struct Resampling {
  Curve points;                  ///< points at nearly equal steps
  std::vector<std::size_t> row;  ///< row of the old point before each
  std::vector<double> share;     ///< share of the way to the next old point, 0..1
};

/// Divides a curve into `pieces`, by Catmull-Rom cubics through its points.
Resampling divided(const Curve& curve, bool closed, std::size_t pieces);
/// The same for pieces of about `step` (m); at least 8 of them.
Resampling divided_by_step(const Curve& curve, bool closed, double step);

/// `count` points at equal steps along a closed curve.
Curve resampled(const Curve& curve, int count);

/// The signed curvatures (1/m) of a closed curve: of circles through points `reach` rows before and after.
std::vector<double> curvature(const Curve& curve, int reach);

/// Unit normals to the left, from the points before and after; 0 where those are the same.
Curve normals(const Curve& curve, bool closed = true);

/// Convolves the values at the points of a curve, whose steps are equal, with a Gaussian of standard
/// deviation `width`, in the unit of `step`. The ends of an open curve keep their values: near them the
/// weights reach equally far to both sides. A width of 0 changes nothing.
template <class Value>
std::vector<Value> smoothed(const std::vector<Value>& values, bool closed, double step, double width) {
  if (!(width > 0)) return values;
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto reach = std::min(n / 2, saturate_cast<std::ptrdiff_t>(std::ceil(4 * width / step)));
  std::vector<double> weight, sum;  // sum: of the weights up to each one, on both sides
  for (std::ptrdiff_t k = 0; k <= reach; ++k) {
    const double away = static_cast<double>(k) * step / width;
    weight.push_back(std::exp(-0.5 * away * away));
    sum.push_back(k == 0 ? weight[0] : sum.back() + 2 * weight.back());
  }
  std::vector<Value> result;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const auto most = static_cast<std::size_t>(closed ? reach : std::min({reach, i, n - 1 - i}));
    const auto at = [&](std::ptrdiff_t row) { return values[within(row, values.size(), closed)]; };
    Value mean = (weight[0] / sum[most]) * at(i);
    for (std::size_t k = 1; k <= most; ++k) {
      const auto away = static_cast<std::ptrdiff_t>(k);
      mean = mean + (weight[k] / sum[most]) * (at(i + away) + at(i - away));
    }
    result.push_back(mean);
  }
  return result;
}

/// The curve smoothed along its length; its steps must be about equal. `width` is in m.
inline Curve smoothed(const Curve& curve, double width, bool closed = true) {
  return smoothed(curve, closed, length(curve, closed) / static_cast<double>(curve.size()), width);
}

/// The least distance (m) of points that are over `apart` m of a closed curve from each other, either way.
double min_gap(const Curve& curve, double apart);

}  // namespace slalom::vehicle::detail
