// Places that count as closed although a map shows room.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/closed_discs.hpp"
#include "slalom/maps/distance_field.hpp"

namespace slalom::maps::distance_field_test {
namespace {

OccupancyGrid random_grid(std::mt19937& random, int width, int height, double density) {
  OccupancyGrid grid{width, height, 0.05, {1, 2, 0.3}, {}};
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < width * height; ++i) {
    const double u = uniform(random);
    grid.cells.push_back(u < density         ? Occupancy::occupied
                         : u < 1.2 * density ? Occupancy::unknown
                                             : Occupancy::free);
  }
  return grid;
}

double brute_force(const OccupancyGrid& grid, int column, int row, bool unknown_is_obstacle) {
  double best = std::numeric_limits<double>::infinity();
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const Occupancy cell = grid.at(x, y);
      if (cell == Occupancy::occupied || (unknown_is_obstacle && cell == Occupancy::unknown)) {
        best = std::min(best, static_cast<double>((x - column) * (x - column) + (y - row) * (y - row)));
      }
    }
  }
  return grid.resolution * std::sqrt(best);
}

TEST(DistanceField, EqualsBruteForceOnRandomGrids) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 120; ++trial) {
    const int width = 1 + static_cast<int>(random() % 40), height = 1 + static_cast<int>(random() % 40);
    const double density = trial % 3 == 0 ? 0.002 : trial % 3 == 1 ? 0.03 : 0.4;
    const OccupancyGrid grid = random_grid(random, width, height, density);
    const bool unknown = trial % 2 == 0;
    const DistanceField field = distance_transform(grid, unknown);
    ASSERT_EQ(field.width, width);
    ASSERT_EQ(field.height, height);
    EXPECT_EQ(field.origin.yaw, grid.origin.yaw);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        ASSERT_EQ(field.at(x, y), brute_force(grid, x, y, unknown))
            << x << ' ' << y << " of " << width << " x " << height;
      }
    }
  }
}

TEST(DistanceField, IsInfiniteWithoutObstacles) {
  const OccupancyGrid grid{3, 2, 0.1, {}, std::vector<Occupancy>(6, Occupancy::unknown)};
  for (const double d : distance_transform(grid, false).distance)
    EXPECT_EQ(d, std::numeric_limits<double>::infinity());
  for (const double d : distance_transform(grid, true).distance) EXPECT_EQ(d, 0);
}

TEST(DistanceField, RejectsAGridWithInconsistentSizes) {
  EXPECT_THROW(distance_transform(OccupancyGrid{}, false), std::invalid_argument);
  EXPECT_THROW(distance_transform(OccupancyGrid{2, 2, 0.1, {}, std::vector<Occupancy>(3)}, false),
               std::invalid_argument);
}

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

TEST(ClosedDiscs, KeepsTheLastFourOfManyDeadEnds) {
  ClosedDiscs discs;
  for (int i = 0; i < 7; ++i) {
    discs.add_dead_end({{10.0 * i, 0}, 0.5});
    for (int k = 0; k <= i; ++k) EXPECT_EQ(discs.contain({10.0 * k, 0}), k > i - 4) << k << " of " << i;
  }
  EXPECT_EQ(discs.all().size(), 4u);
  discs.forget_dead_ends();
  EXPECT_FALSE(discs.has_dead_ends());
  EXPECT_FALSE(discs.contain({60, 0}));
}

TEST(ClosedDiscs, AMeetingIsClosedWhileItLasts) {
  ClosedDiscs discs;
  for (int i = 0; i < 4; ++i) discs.add_dead_end({{10.0 * i, 0}, 0.5});
  discs.begin_meeting({{50, 0}, 1});
  EXPECT_TRUE(discs.contain({50.9, 0}));
  EXPECT_TRUE(discs.contain({30, 0}));
  discs.end_meeting();
  EXPECT_FALSE(discs.contain({50, 0}));
  EXPECT_TRUE(discs.contain({30, 0}));
}

}  // namespace

}  // namespace slalom::maps::distance_field_test
