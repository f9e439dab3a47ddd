#include "slalom/sim/room/room.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace slalom::sim {
namespace {

/// 6 x 4 m with a wall at x = 3 from y = 0 to 2, and a pallet.
const Room room{6, 4, {{{3, 1, 0}, 0.2, 2}}, {{{4.5, 3, 0}, 0.8, 1.2}}};

TEST(Room, TheMapShowsTheWallsAlone) {
  const maps::OccupancyGrid map = map_of(room, 0.05);
  EXPECT_EQ(map.width, 122);
  EXPECT_EQ(map.height, 82);
  const auto at = [&](double x, double y) {
    return map.at(static_cast<int>(std::floor((x - map.origin.x) / 0.05)),
                  static_cast<int>(std::floor((y - map.origin.y) / 0.05)));
  };
  EXPECT_EQ(at(3, 1), maps::Occupancy::occupied);
  EXPECT_EQ(at(2.91, 1.97), maps::Occupancy::occupied);
  EXPECT_EQ(at(2.88, 1), maps::Occupancy::free);
  EXPECT_EQ(at(3, 2.03), maps::Occupancy::free);
  EXPECT_EQ(at(-0.02, 1), maps::Occupancy::occupied);
  EXPECT_EQ(at(4.5, 3), maps::Occupancy::free);
  EXPECT_THROW(map_of({0.5, 4, {}, {}}, 0.05), std::invalid_argument);
  EXPECT_THROW(map_of(room, 0), std::invalid_argument);
}

TEST(Room, TheMapEndsWhereTheFloorEnds) {
  const maps::OccupancyGrid even = map_of({2.22, 4.44, {}, {}}, 0.02);
  EXPECT_EQ(even.width, 113) << "111 cells and the rim: 2.22 / 0.02 is above 111 in doubles";
  EXPECT_EQ(even.height, 224);
  const maps::OccupancyGrid uneven = map_of({2.221, 4.459, {}, {}}, 0.02);
  EXPECT_EQ(uneven.width, 114);
  EXPECT_EQ(uneven.height, 225);
}

TEST(Room, BodiesCollideWithWallsObstaclesAndTheEdge) {
  const auto hits = [](double x, double y, double yaw) { return collides(room, {{x, y, yaw}, 0.7, 0.5}); };
  EXPECT_FALSE(hits(1, 1, 0));
  EXPECT_TRUE(hits(2.56, 1, 0));
  EXPECT_FALSE(hits(2.54, 1, 0));
  EXPECT_FALSE(hits(2.64, 1, M_PI_2)) << "its side is nearer than its front";
  EXPECT_TRUE(hits(4.5, 2.16, 0));
  EXPECT_FALSE(hits(4.5, 2.14, 0));
  EXPECT_TRUE(hits(0.34, 1, 0));
  EXPECT_FALSE(hits(0.36, 1, 0));
}

TEST(Room, ScansMeasureTheDistances) {
  std::vector<double> ranges(4);
  scan(room, {1, 1, 0}, 8, ranges);
  EXPECT_NEAR(ranges[0], 1.9, 1e-9);
  EXPECT_NEAR(ranges[1], 3, 1e-9);
  EXPECT_NEAR(ranges[2], 1, 1e-9);
  EXPECT_NEAR(ranges[3], 1, 1e-9);
  scan(room, {2, 3, 0}, 8, ranges);
  EXPECT_NEAR(ranges[0], 2.1, 1e-9) << "the pallet";
  scan(room, {1, 1, M_PI_2}, 1.5, ranges);
  EXPECT_EQ(ranges[0], 1.5) << "out of range";
  EXPECT_EQ(ranges[3], 1.5) << "the wall is out of range too";
}

}  // namespace
}  // namespace slalom::sim
