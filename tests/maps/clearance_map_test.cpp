#include "slalom/maps/clearance_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace slalom::maps {
namespace {

TEST(ClearanceMap, HoldsTheDistanceToTheNearestPointUpToItsReach) {
  ClearanceMap map({.reach = 0.6});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-2.4, 8.4), across(-5.4, 5.4);
  std::vector<Point> points(60);
  for (Point& p : points) p = {along(random), across(random)};
  map.add(points);
  int near = 0;
  for (double x = -1.95; x < 8; x += 0.173) {
    for (double y = -4.95; y < 5; y += 0.131) {
      double nearest = 1e9;
      for (const Point& p : points) nearest = std::min(nearest, std::hypot(p.x - x, p.y - y));
      EXPECT_NEAR(map.at(x, y), std::min(nearest, 0.6),
                  0.0708);  // half a diagonal each for the point and the position
      near += nearest < 0.5;
    }
  }
  EXPECT_GT(near, 200);
}

TEST(ClearanceMap, IsNegativeOutsideAndIgnoresNonFinitePoints) {
  ClearanceMap map;
  EXPECT_EQ(map.at(8.01, 0), -1);
  EXPECT_EQ(map.at(0, -5.01), -1);
  const std::vector<Point> bad{{NAN, 0}, {0, INFINITY}, {1e300, 0}};
  map.add(bad);
  EXPECT_EQ(map.at(1, 0), 0.5F);
  const std::vector<ScanPoint> one{{1, 0}};
  map.add(one);
  EXPECT_LT(map.at(1, 0), 0.08F);
  map.clear();
  EXPECT_EQ(map.at(1, 0), 0.5F);
}

TEST(ClearanceMap, RejectsInvalidOptions) {
  EXPECT_THROW(ClearanceMap({.resolution = 0}), std::invalid_argument);
  EXPECT_THROW(ClearanceMap({.reach = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::maps
