#include "slalom/navigation/scan_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "navigation/grids.hpp"
#include "support/allocations.hpp"

namespace slalom::navigation {
namespace {

using maps::Occupancy;

/// 4 x 4 m around the origin with a wall at x = 1.5.
maps::OccupancyGrid walled() {
  maps::OccupancyGrid grid = free_grid(-2, -2, 4, 4);
  fill(grid, 1.5, -2, 1.6, 2);
  return grid;
}

Occupancy at(const ScanMap& map, double x, double y) {
  return map.grid().at(static_cast<int>(std::floor((x + 2) / 0.05)),
                       static_cast<int>(std::floor((y + 2) / 0.05)));
}

TEST(ScanMap, MarksWhereBeamsEndAndClearsWhatTheyCross) {
  ScanMap map(walled());
  std::vector<double> ranges{1.02, 8, 0.52, 8};  // ahead, left, behind, right
  map.add({{0.01, 0.01, 0}, ranges, 8});
  EXPECT_EQ(at(map, 1.03, 0.01), Occupancy::occupied);
  EXPECT_EQ(at(map, -0.51, 0.01), Occupancy::occupied);
  EXPECT_EQ(at(map, 0.5, 0.01), Occupancy::free);
  ranges[0] = 1.5;  // what stood there has gone
  map.add({{0.01, 0.01, 0}, ranges, 8});
  EXPECT_EQ(at(map, 1.03, 0.01), Occupancy::free);
  EXPECT_EQ(at(map, -0.51, 0.01), Occupancy::occupied);
}

TEST(ScanMap, NeverClearsWhatTheMapKnows) {
  ScanMap map(walled());
  const std::vector<double> ranges{8, 8, 8, 8};
  map.add({{0.01, 0.01, 0}, ranges, 8});
  EXPECT_EQ(at(map, 1.55, 0.01), Occupancy::occupied);
}

TEST(ScanMap, DropsInvalidBeamsAndAllocatesNothing) {
  ScanMap map(walled());
  const std::vector<Occupancy> before = map.grid().cells;
  const std::vector<double> ranges{std::nan(""), -1, INFINITY, std::nan("")};
  const std::vector<double> away{1, 1, 1, 1};
  const long allocations = testing::allocations();
  map.add({{0.01, 0.01, 0}, ranges, 8});
  map.add({{1e9, 0, 0}, away, 8});
  EXPECT_EQ(testing::allocations(), allocations);
  EXPECT_TRUE(map.grid().cells == before);
  maps::OccupancyGrid turned = walled();
  turned.origin.yaw = 1;
  EXPECT_THROW(ScanMap{turned}, std::invalid_argument);
  EXPECT_THROW(ScanMap{maps::OccupancyGrid{}}, std::invalid_argument);
}

}  // namespace
}  // namespace slalom::navigation
