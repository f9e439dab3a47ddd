// The line of least curvature: known answers and optimality.
#include "slalom/vehicle/course/raceline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace slalom::vehicle::raceline_test {
namespace {

constexpr double pi = 3.14159265358979323846;

std::vector<maps::Point> ellipse(int count, double a, double b) {
  std::vector<maps::Point> points;
  for (int i = 0; i < count; ++i)
    points.push_back({a * std::cos(2 * pi * i / count), b * std::sin(2 * pi * i / count)});
  return points;
}

/// The objective, from its definition.
double bending(const std::vector<maps::Point>& points, const std::vector<double>& offsets) {
  const std::size_t n = points.size();
  std::vector<maps::Point> line(n);
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point &a = points[(i + n - 1) % n], &b = points[(i + 1) % n];
    const double size = std::hypot(b.x - a.x, b.y - a.y);
    line[i] = {points[i].x - offsets[i] * (b.y - a.y) / size, points[i].y + offsets[i] * (b.x - a.x) / size};
  }
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point &a = line[(i + n - 1) % n], &b = line[i], &c = line[(i + 1) % n];
    sum += std::pow(a.x - 2 * b.x + c.x, 2) + std::pow(a.y - 2 * b.y + c.y, 2);
  }
  return sum;
}

TEST(Raceline, RunsAlongTheInnerBoundOfACircle) {
  // Equal steps of the parameter: the objective falls with the radius, so the whole line moves to the inside.
  for (const double offset : minimum_curvature_offsets(ellipse(96, 5, 5), 0.7))
    EXPECT_NEAR(offset, 0.7, 1e-9);
}

TEST(Raceline, IsOptimalWithinItsBounds) {
  const double bound = 0.6;
  const auto points = ellipse(160, 9, 4);
  auto offsets = minimum_curvature_offsets(points, bound);
  const double best = bending(points, offsets);
  EXPECT_LT(best, bending(points, std::vector<double>(points.size(), 0.0)));
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    ASSERT_LE(std::abs(offsets[i]), bound);
    for (const double move : {-1e-3, 1e-3}) {
      const double kept = offsets[i];
      offsets[i] = std::fmin(std::fmax(kept + move, -bound), bound);
      EXPECT_GE(bending(points, offsets), best - 1e-9) << "moving row " << i << " by " << move;
      offsets[i] = kept;
    }
  }
}

TEST(Raceline, RejectsTooFewPointsAndInvalidBounds) {
  EXPECT_EQ(minimum_curvature_offsets(ellipse(64, 8, 5), 0), std::vector<double>(64));
  EXPECT_THROW(minimum_curvature_offsets(ellipse(7, 5, 5), 0.5), std::invalid_argument);
  EXPECT_THROW(minimum_curvature_offsets(ellipse(20, 5, 5), -0.1), std::invalid_argument);
  EXPECT_THROW(minimum_curvature_offsets(ellipse(20, 5, 5), std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::vehicle::raceline_test
