#include "vehicle/course/closed_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slalom::vehicle::detail {
namespace {

Curve resampled_once(const Curve& curve, int count) {
  const int n = static_cast<int>(curve.size());
  const double step = length(curve) / count;
  Curve result;
  result.reserve(count);
  double walked = 0;
  int i = 0;
  for (int k = 0; k < count; ++k) {
    const double wanted = k * step;
    double stretch = 0;
    for (;; ++i) {
      const maps::Point d = curve[(i + 1) % n] - curve[i % n];
      stretch = std::hypot(d.x, d.y);
      if (walked + stretch > wanted || i >= n) break;
      walked += stretch;
    }
    const double t = std::clamp((wanted - walked) / stretch, 0.0, 1.0);
    result.push_back(
        catmull_rom(curve[(i + n - 1) % n], curve[i % n], curve[(i + 1) % n], curve[(i + 2) % n], t));
  }
  return result;
}

}  // namespace

maps::Point catmull_rom(maps::Point a, maps::Point b, maps::Point c, maps::Point d, double t) {
  const maps::Point linear = c - a;
  const maps::Point square = 2 * a - 5 * b + 4 * c - d;
  const maps::Point cube = 3 * (b - c) + d - a;
  return b + 0.5 * (t * (linear + t * (square + t * cube)));
}

double length(const Curve& curve) {
  double sum = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const maps::Point d = curve[(i + 1) % curve.size()] - curve[i];
    sum += std::hypot(d.x, d.y);
  }
  return sum;
}

Curve resampled(const Curve& curve, int count) {
  // Equal chords between the old points are only nearly equal between the new ones; the second pass corrects
  // that.
  return resampled_once(resampled_once(curve, count), count);
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

Curve normals(const Curve& curve) {
  const std::size_t n = curve.size();
  Curve result(n);
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point d = curve[(i + 1) % n] - curve[(i + n - 1) % n];
    const double size = std::hypot(d.x, d.y);
    result[i] = {-d.y / size, d.x / size};
  }
  return result;
}

Curve smoothed(const Curve& curve, double width) {
  const int n = static_cast<int>(curve.size());
  const double step = length(curve) / n;
  const int reach = std::min(n / 2, static_cast<int>(std::ceil(4 * width / step)));
  std::vector<double> weight(reach + 1);
  double sum = 0;
  for (int k = 0; k <= reach; ++k) {
    weight[k] = std::exp(-0.5 * (k * step / width) * (k * step / width));
    sum += k == 0 ? weight[k] : 2 * weight[k];
  }
  Curve result(n);
  for (int i = 0; i < n; ++i) {
    maps::Point mean = (weight[0] / sum) * curve[i];
    for (int k = 1; k <= reach; ++k)
      mean = mean + (weight[k] / sum) * (curve[(i + k) % n] + curve[(i + n - k) % n]);
    result[i] = mean;
  }
  return result;
}

double min_gap(const Curve& curve, double apart) {
  const int n = static_cast<int>(curve.size());
  const int away = static_cast<int>(std::ceil(apart / (length(curve) / n)));
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < n; ++i)
    for (int j = i + away; j < n && j - i <= n - away; ++j) {
      const maps::Point d = curve[j] - curve[i];
      least = std::min(least, dot(d, d));
    }
  return std::sqrt(least);
}

}  // namespace slalom::vehicle::detail
