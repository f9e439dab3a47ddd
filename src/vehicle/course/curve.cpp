#include "vehicle/course/curve.hpp"

namespace slalom::vehicle::detail {
namespace {

/// The Catmull-Rom cubic between b and c at t in [0, 1].
maps::Point catmull_rom(maps::Point a, maps::Point b, maps::Point c, maps::Point d, double t) {
  const maps::Point linear = c - a;
  const maps::Point square = 2 * a - 5 * b + 4 * c - d;
  const maps::Point cube = 3 * (b - c) + d - a;
  return b + 0.5 * (t * (linear + t * (square + t * cube)));
}

}  // namespace

double length(const Curve& curve, bool closed) {
  double sum = 0;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < curve.size(); ++i)
    sum += distance(curve[i], curve[(i + 1) % curve.size()]);
  return sum;
}

Resampling divided(const Curve& curve, bool closed, std::size_t pieces) {
  const std::size_t count = closed ? pieces : pieces + 1, n = curve.size();
  const std::size_t last = closed ? n - 1 : n - 2;  // the last row from which a stretch begins
  const double step = length(curve, closed) / static_cast<double>(pieces);
  Resampling result;
  double walked = 0;
  std::size_t row = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted = static_cast<double>(k) * step;
    double stretch = distance(curve[row], curve[(row + 1) % n]);
    for (; walked + stretch <= wanted && row < last; stretch = distance(curve[row], curve[(row + 1) % n])) {
      walked += stretch;
      ++row;
    }
    const double t = stretch > 0 ? std::clamp((wanted - walked) / stretch, 0.0, 1.0) : 0;
    const auto at = [&](int ahead) {
      return curve[within(static_cast<std::ptrdiff_t>(row) + ahead, n, closed)];
    };
    result.points.push_back(catmull_rom(at(-1), at(0), at(1), at(2), t));
    result.row.push_back(row);
    result.share.push_back(t);
  }
  return result;
}

Resampling divided_by_step(const Curve& curve, bool closed, double step) {
  const auto pieces = saturate_cast<std::size_t>(std::round(length(curve, closed) / step));
  return divided(curve, closed, std::max<std::size_t>(8, pieces));
}

Curve resampled(const Curve& curve, int count) {
  // Equal chords between the old points are only nearly equal between the new ones, hence the second pass.
  const auto pieces = static_cast<std::size_t>(count);
  return divided(divided(curve, true, pieces).points, true, pieces).points;
}

std::vector<double> curvature(const Curve& curve, int reach) {
  const std::size_t n = curve.size();
  std::vector<double> result(n);
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point a = curve[(i + n - reach) % n], b = curve[i], c = curve[(i + reach) % n];
    const maps::Point ab = b - a, bc = c - b, ac = c - a;
    result[i] = 2 * cross(ab, bc) / std::sqrt(dot(ab, ab) * dot(bc, bc) * dot(ac, ac));
  }
  return result;
}

Curve normals(const Curve& curve, bool closed) {
  Curve result;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const auto row = static_cast<std::ptrdiff_t>(i);
    const maps::Point d =
        curve[within(row + 1, curve.size(), closed)] - curve[within(row - 1, curve.size(), closed)];
    const double size = std::hypot(d.x, d.y), share = size > 0 ? 1 / size : 0;
    result.push_back({-d.y * share, d.x * share});
  }
  return result;
}

double min_gap(const Curve& curve, double apart) {
  const int n = static_cast<int>(curve.size());
  const int away = saturate_cast<int>(std::min(std::ceil(apart / (length(curve) / n)), 1.0 * n));
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < n; ++i)
    for (int j = i + away; j < n && j - i <= n - away; ++j) {
      const maps::Point d = curve[j] - curve[i];
      least = std::min(least, dot(d, d));
    }
  return std::sqrt(least);
}

}  // namespace slalom::vehicle::detail
