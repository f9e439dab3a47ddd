#include "slalom/maps/clearance_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace slalom::maps::clearance_map_test {
namespace {

/// The kernel of a point is written in packs, and cell by cell where it reaches over the edge.
TEST(ClearanceMap, HoldsTheDistanceBetweenCellsEverywhere) {
  const ClearanceMapOptions options{.length_x = 2.2, .length_y = 3.1, .center_x = 0, .reach = 0.37};
  ClearanceMap map(options);
  const GridGeometry& geometry = map.geometry();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(-1.5, 1.5), across(-2, 2);
  for (int round = 0; round < 20; ++round) {
    std::vector<Point> points(6);
    for (Point& p : points) p = {along(random), across(random)};
    map.clear();
    map.add(points);
    for (int row = 0; row < geometry.rows; ++row)
      for (int column = 0; column < geometry.columns; ++column) {
        float nearest = static_cast<float>(options.reach);
        for (const Point& p : points) {
          const double u = std::floor(-p.x / 0.05 + 0.5 * geometry.rows),
                       v = std::floor(-p.y / 0.05 + 0.5 * geometry.columns);
          nearest = std::min(nearest, static_cast<float>(0.05 * std::hypot(row - u, column - v)));
        }
        ASSERT_EQ(map.at(geometry.cell_x(row), geometry.cell_y(column)), nearest) << row << ' ' << column;
      }
    for (const double x : {-1.2, 1.2}) EXPECT_EQ(map.at(x, 0), -1) << "the ring is untouched";
    for (const double y : {-1.6, 1.6}) EXPECT_EQ(map.at(0, y), -1) << "the ring is untouched";
  }
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

}  // namespace
}  // namespace slalom::maps::clearance_map_test
