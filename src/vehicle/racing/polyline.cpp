#include "vehicle/racing/polyline.hpp"

#include <algorithm>
#include <cmath>

#include "vehicle/course/closed_curve.hpp"

namespace slalom::vehicle::detail {
namespace {

/// An index of a line, brought back into it: round a closed line, to the ends of an open one.
std::size_t within(std::ptrdiff_t i, std::size_t count, bool closed) {
  const auto n = static_cast<std::ptrdiff_t>(count);
  return static_cast<std::size_t>(closed ? (i % n + n) % n : std::clamp<std::ptrdiff_t>(i, 0, n - 1));
}

std::vector<double> gaussian(double deviation) {
  std::vector<double> weights;
  const int reach = static_cast<int>(std::ceil(4 * deviation));
  for (int k = 0; k <= reach; ++k) weights.push_back(std::exp(-0.5 * k * k / (deviation * deviation)));
  return weights;
}

}  // namespace

double line_length(const std::vector<maps::Point>& points, bool closed) {
  double sum = closed && points.size() > 1 ? distance(points.back(), points.front()) : 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += distance(points[i - 1], points[i]);
  return sum;
}

std::vector<maps::Point> line_normals(const std::vector<maps::Point>& points, bool closed) {
  std::vector<maps::Point> normals;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto k = static_cast<std::ptrdiff_t>(i);
    const maps::Point d =
        points[within(k + 1, points.size(), closed)] - points[within(k - 1, points.size(), closed)];
    const double size = std::hypot(d.x, d.y);
    normals.push_back({-d.y / size, d.x / size});
  }
  return normals;
}

std::vector<double> values_smoothed(const std::vector<double>& values, bool closed, double reach) {
  const auto weights = gaussian(reach);
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  std::vector<double> result;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    // Near the ends of an open line the weights reach equally far to both sides, so that the ends stay.
    auto most = static_cast<std::ptrdiff_t>(weights.size()) - 1;
    most = closed ? std::min(most, n / 2) : std::min({most, i, n - 1 - i});
    double sum = weights[0] * values[static_cast<std::size_t>(i)], total = weights[0];
    for (std::ptrdiff_t k = 1; k <= most; ++k) {
      sum += weights[static_cast<std::size_t>(k)] *
             (values[within(i - k, values.size(), closed)] + values[within(i + k, values.size(), closed)]);
      total += 2 * weights[static_cast<std::size_t>(k)];
    }
    result.push_back(sum / total);
  }
  return result;
}

std::vector<maps::Point> line_smoothed(const std::vector<maps::Point>& points, bool closed, double width) {
  const double step = line_length(points, closed) / static_cast<double>(points.size());
  std::vector<double> x, y;
  for (const maps::Point& point : points) {
    x.push_back(point.x);
    y.push_back(point.y);
  }
  x = values_smoothed(x, closed, width / step);
  y = values_smoothed(y, closed, width / step);
  std::vector<maps::Point> result;
  for (std::size_t i = 0; i < x.size(); ++i) result.push_back({x[i], y[i]});
  return result;
}

Resampling equal_steps(const std::vector<maps::Point>& points, bool closed, double step) {
  const double length = line_length(points, closed);
  const auto pieces = std::max<std::size_t>(8, static_cast<std::size_t>(std::lround(length / step)));
  const std::size_t count = closed ? pieces : pieces + 1, n = points.size();
  const std::size_t last = closed ? n - 1 : n - 2;  // the last row from which a stretch begins
  Resampling result;
  double walked = 0;
  std::size_t row = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted = length * static_cast<double>(k) / static_cast<double>(pieces);
    double stretch = distance(points[row], points[(row + 1) % n]);
    while (walked + stretch < wanted && row < last) {
      walked += stretch;
      ++row;
      stretch = distance(points[row], points[(row + 1) % n]);
    }
    const double t = stretch > 0 ? std::clamp((wanted - walked) / stretch, 0.0, 1.0) : 0;
    const auto at = [&](int ahead) {
      return points[within(static_cast<std::ptrdiff_t>(row) + ahead, n, closed)];
    };
    const maps::Point a = at(-1), b = at(0), c = at(1), d = at(2);
    result.points.push_back(catmull_rom(a, b, c, d, t));
    result.row.push_back(row);
    result.share.push_back(t);
  }
  return result;
}

}  // namespace slalom::vehicle::detail
