#include "slalom/maps/distance_field.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>

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

}  // namespace
}  // namespace slalom::maps::distance_field_test
