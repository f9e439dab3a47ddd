#include "slalom/navigation/costmap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "navigation/grids.hpp"
#include "slalom/core/random.hpp"
#include "slalom/navigation/navigation_problem.hpp"
#include "support/allocations.hpp"

namespace slalom::navigation {
namespace {

using maps::Pose;

Costmap costmap_of(const maps::OccupancyGrid& grid, UnknownCells unknown = UnknownCells::obstacle) {
  Costmap costmap(grid.width, grid.height, grid.resolution, unknown);
  EXPECT_TRUE(costmap.update(grid));
  return costmap;
}

/// 5 x 4 m with scattered cells.
maps::OccupancyGrid scattered(std::uint64_t seed) {
  maps::OccupancyGrid grid = free_grid(-2, 10, 5, 4);
  RandomStream random({seed, 0});
  for (auto& cell : grid.cells)
    if (random.uniform() < 0.003) cell = maps::Occupancy::occupied;
  return grid;
}

/// Whether a point of the body, on a raster of 4 mm, lies in an obstacle cell.
bool overlaps(const maps::OccupancyGrid& grid, const Footprint& body, const Pose& pose) {
  for (double x = -0.8; x <= 0.8; x += 0.004)
    for (double y = -0.8; y <= 0.8; y += 0.004) {
      if (!body.contains({x, y})) continue;
      const maps::Point p = maps::transform(pose, {x, y});
      const int column = static_cast<int>(std::floor((p.x - grid.origin.x) / grid.resolution)),
                row = static_cast<int>(std::floor((p.y - grid.origin.y) / grid.resolution));
      if (!grid.contains(column, row) || grid.at(column, row) == maps::Occupancy::occupied) return true;
    }
  return false;
}

TEST(Costmap, DistancesAreThoseToTheNearestObstacle) {
  maps::OccupancyGrid grid = free_grid(0, 0, 4, 3);
  fill(grid, 2, 1, 2.2, 1.2);
  const Costmap costmap = costmap_of(grid);
  EXPECT_EQ(costmap.distance(2.1, 1.1), 0);
  EXPECT_NEAR(costmap.distance(1.525, 1.125), 0.5, 1e-6);
  EXPECT_NEAR(costmap.distance(1.725, 0.625), 0.5, 1e-6);  // 0.3 and 0.4 m away
  EXPECT_NEAR(costmap.distance(0.125, 1.525), 0.15, 1e-6) << "what lies off the map is unknown";
  EXPECT_EQ(costmap.distance(-1, 1), 0);
}

TEST(Costmap, UnknownCellsAreObstaclesOrHaveAPrice) {
  maps::OccupancyGrid grid = free_grid(0, 0, 4, 3);
  fill(grid, 2, 1, 2.2, 1.2, maps::Occupancy::unknown);
  const Costmap closed = costmap_of(grid), open = costmap_of(grid, UnknownCells::priced);
  const Footprint body = Footprint::rectangle(0.2, 0.2, 0.3);
  EXPECT_TRUE(closed.collides(body, {2.1, 1.1, 0}));
  EXPECT_FALSE(open.collides(body, {2.1, 1.1, 0}));
  EXPECT_TRUE(closed.collides(body, {-0.1, 1, 0}));
  EXPECT_FALSE(open.collides(body, {-0.1, 1, 0}));
  EXPECT_EQ(look_up(open.prices(), 2.1, 1.1), 1);
  EXPECT_EQ(look_up(open.prices(), 1.0, 1.1), 0);
  EXPECT_EQ(look_up(closed.prices(), 2.1, 1.1), 0);
}

TEST(Costmap, TakesPricesOfCells) {
  maps::OccupancyGrid grid = free_grid(-1, 2, 3, 2);
  Costmap costmap = costmap_of(grid);
  std::vector<float> prices(grid.cells.size());
  prices[0] = 3;  // lower left corner
  prices[1] = -1;
  EXPECT_TRUE(costmap.update(grid, prices));
  EXPECT_EQ(look_up(costmap.prices(), -0.975, 2.025), 3);
  EXPECT_EQ(look_up(costmap.prices(), -0.925, 2.025), 0);
  EXPECT_TRUE(costmap.update(grid));
  EXPECT_EQ(look_up(costmap.prices(), -0.975, 2.025), 0);
  prices.pop_back();
  EXPECT_FALSE(costmap.update(grid, prices));
}

TEST(Costmap, CollisionsAreExact) {
  const maps::OccupancyGrid grid = scattered(3);
  const Costmap costmap = costmap_of(grid);
  const Footprint body = Footprint::rectangle(0.3, 0.2, 0.36),
                  larger = Footprint::rectangle(0.306, 0.206, 0.372);
  RandomStream random({4, 0});
  int collisions = 0;
  for (int i = 0; i < 150; ++i) {
    const Pose pose{-1.5 + 4 * random.uniform(), 10.5 + 3 * random.uniform(), 6.28 * random.uniform()};
    const bool raster = overlaps(grid, body, pose);
    collisions += raster;
    if (raster) {
      EXPECT_TRUE(costmap.collides(body, pose)) << pose.x << ", " << pose.y << ", " << pose.yaw;
    }
    if (costmap.collides(body, pose)) {
      EXPECT_TRUE(overlaps(grid, larger, pose)) << pose.x << ", " << pose.y << ", " << pose.yaw;
    }
  }
  EXPECT_GT(collisions, 20);
  EXPECT_LT(collisions, 130);
}

TEST(Costmap, CollidesWhereNoPoseCanBe) {
  const Footprint body = Footprint::rectangle(0.3, 0.2, 0.36);
  const double nan = std::nan("");
  for (const UnknownCells unknown : {UnknownCells::obstacle, UnknownCells::priced}) {
    const Costmap costmap = costmap_of(free_grid(0, 0, 4, 3), unknown);
    EXPECT_FALSE(costmap.collides(body, {2, 1.5, 0}));
    for (const Pose& pose :
         {Pose{2, 1.5, nan}, {nan, 1.5, 0}, {1e9, 1.5, 0}, {2, -1.3e8, 0}, {2, 1.5, 1e300}})
      EXPECT_TRUE(costmap.collides(body, pose)) << pose.x << ", " << pose.y << ", " << pose.yaw;
    EXPECT_EQ(costmap.collides(body, {9e6, 1.5, 0}), unknown == UnknownCells::obstacle);
  }
}

TEST(Costmap, SeesWhatABodyTouchesBetweenTwoPoses) {
  maps::OccupancyGrid grid = free_grid(0, 0, 4, 4);
  fill(grid, 2, 1, 2.04, 1.04);  // one cell
  const Costmap costmap = costmap_of(grid);
  const Footprint body = Footprint::rectangle(0.3, 0.2, 0.36);
  const Pose before{1, 1, 0}, behind{3, 1, 0}, beside{1, 1.5, 0}, far{3, 1.5, 0};
  EXPECT_FALSE(costmap.collides(body, before) || costmap.collides(body, behind));
  EXPECT_TRUE(costmap.collides(body, before, behind));
  EXPECT_FALSE(costmap.collides(body, beside, far));
  // A corner sweeps over the cell while the body turns, past half a turn too.
  const Pose turning{1.65, 1.02, 0.5}, turned{1.65, 1.02, -0.5};
  const Footprint narrow = Footprint::rectangle(0.36, 0.2, 0.1);
  EXPECT_FALSE(costmap.collides(narrow, turning) || costmap.collides(narrow, turned));
  EXPECT_TRUE(costmap.collides(narrow, turning, turned));
  EXPECT_TRUE(costmap.collides(narrow, turning, {1.65, 1.02, -0.5 + 6.283185307}));
}

TEST(Costmap, RolloutsMissNoCollisionDeeperThanHalfACell) {
  maps::OccupancyGrid grid = free_grid(-2, 10, 5, 4);
  RandomStream places({5, 0});
  for (int i = 0; i < 12; ++i) {
    const double x = places.uniform(-2, 3), y = places.uniform(10, 14);
    fill(grid, x, y, x + 0.3, y + 0.3);
  }
  const Costmap costmap = costmap_of(grid);
  const Footprint body = Footprint::rectangle(0.35, 0.25, 0.4),
                  core = Footprint::rectangle(0.325, 0.225, 0.35);
  const BodyCheck check(body, grid.resolution);
  RandomStream random({6, 0});
  int collisions = 0;
  for (int i = 0; i < 20000; ++i) {
    const Pose pose{-1.5 + 4 * random.uniform(), 10.5 + 3 * random.uniform(), 6.28 * random.uniform()};
    const auto contact =
        check.check<double>(costmap.distances(), pose.x, pose.y, std::sin(pose.yaw), std::cos(pose.yaw));
    collisions += contact.collided;
    if (contact.collided) {
      EXPECT_TRUE(costmap.collides(body, pose)) << pose.x << ", " << pose.y;
    }
    if (costmap.collides(core, pose)) {
      EXPECT_TRUE(contact.collided) << pose.x << ", " << pose.y;
    }
  }
  EXPECT_GT(collisions, 1000);
}

TEST(Costmap, MovesWithItsGridAndDoesNotAllocate) {
  maps::OccupancyGrid grid = free_grid(0, 0, 4, 3);
  fill(grid, 2, 1, 2.2, 1.2);
  Costmap costmap = costmap_of(grid);
  grid.origin = {100, -50, 0};
  const long before = testing::allocations();
  EXPECT_TRUE(costmap.update(grid));
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_EQ(costmap.distance(102.1, -48.9), 0);
  EXPECT_EQ(costmap.distance(2.1, 1.1), 0) << "off the map";
  maps::OccupancyGrid turned = grid, smaller = free_grid(0, 0, 3, 3);
  turned.origin.yaw = 0.1;
  EXPECT_FALSE(costmap.update(turned));
  EXPECT_FALSE(costmap.update(smaller));
  EXPECT_EQ(costmap.distance(102.1, -48.9), 0);
}

TEST(Costmap, RejectsInvalidSizes) {
  EXPECT_THROW(Costmap(2, 10, 0.05), std::invalid_argument);
  EXPECT_THROW(Costmap(10, 20001, 0.05), std::invalid_argument);
  EXPECT_THROW(Costmap(10, 10, 0), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::navigation
