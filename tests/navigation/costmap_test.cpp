#include "slalom/navigation/costmap.hpp"

#include "navigation/grids.hpp"
#include "slalom/core/random.hpp"
#include "slalom/navigation/footprint.hpp"
#include "slalom/navigation/navigation_problem.hpp"
#include "slalom/navigation/scan_map.hpp"
#include "support/allocations.hpp"
#include "support/promise.hpp"
#include "support/thrown_words.hpp"

namespace slalom::navigation::costmap_test {
namespace {

using maps::Pose;

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
    const bool collides = costmap.collides(body, pose);
    EXPECT_TRUE(collides || !raster) << pose.x << ", " << pose.y << ", " << pose.yaw;
    EXPECT_TRUE(!collides || overlaps(grid, larger, pose)) << pose.x << ", " << pose.y << ", " << pose.yaw;
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
  // A corner of the body cuts that of the cell on a way that is shorter than a cell.
  const Pose below{1.686, 1.211, 0}, above{1.721, 1.246, 0};
  EXPECT_FALSE(costmap.collides(body, below) || costmap.collides(body, above));
  EXPECT_TRUE(costmap.collides(body, below, above));
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
    const auto contact = check.check<double>(costmap.distances(), pose.x, pose.y, std::sin(pose.yaw),
                                             std::cos(pose.yaw), true);
    collisions += contact.collided;
    EXPECT_TRUE(!contact.collided || costmap.collides(body, pose)) << pose.x << ", " << pose.y;
    EXPECT_TRUE(contact.collided || !costmap.collides(core, pose)) << pose.x << ", " << pose.y;
  }
  EXPECT_GT(collisions, 1000);
}

TEST(Costmap, MovesWithItsGridDoesNotAllocateAndRejectsInvalidSizes) {
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
  for (const auto& [width, height, resolution] : {std::tuple{2, 10, 0.05}, {10, 20001, 0.05}, {10, 10, 0.0}})
    EXPECT_THROW(Costmap(width, height, resolution), std::invalid_argument);
  turned.origin.yaw = 0.1;
  EXPECT_FALSE(costmap.update(turned));
  EXPECT_FALSE(costmap.update(smaller));
  EXPECT_EQ(costmap.distance(102.1, -48.9), 0);
}

using maps::Point;

/// A star-shaped polygon around the origin.
Footprint random_footprint(RandomStream& random) {
  const int count = 3 + static_cast<int>(8 * random.uniform());
  std::vector<Point> vertices;
  for (int i = 0; i < count; ++i) {
    const double angle = 6.2831853 * (i + 0.5 * random.uniform()) / count, radius = 0.2 + random.uniform();
    vertices.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return Footprint(vertices);
}

TEST(Footprint, ARectangleHasItsMeasures) {
  const Footprint body = Footprint::rectangle(0.5, 0.3, 0.6);
  EXPECT_NEAR(body.circumscribed_radius(), std::hypot(0.5, 0.3), 1e-12);
  EXPECT_NEAR(body.half_width(), 0.3, 1e-12);
  EXPECT_TRUE(body.contains({0.49, -0.29}));
  EXPECT_FALSE(body.contains({-0.31, 0}));
  EXPECT_NEAR(body.distance_to_outline({0, 0}), 0.3, 1e-12);
  EXPECT_NEAR(body.distance_to_outline({1.5, 0}), 1, 1e-12);
}

TEST(Footprint, ThePartsCoverTheBodyAndContainNothingElse) {
  RandomStream random({1, 0});
  for (int shape = 0; shape < 100; ++shape) {
    const Footprint body = random_footprint(random);
    for (int i = 0; i < 1000; ++i) {
      const Point p{2.4 * random.uniform() - 1.2, 2.4 * random.uniform() - 1.2};
      const auto reaches = [&](const Footprint::Part& part, double radius) {
        return std::hypot(p.x - part.middle.x, p.y - part.middle.y) < radius - 1e-9;
      };
      const auto& parts = body.parts();
      if (body.contains(p)) {
        EXPECT_TRUE(std::any_of(parts.begin(), parts.end(),
                                [&](const auto& part) { return reaches(part, part.covering + 2e-9); }))
            << shape << ": " << p.x << ", " << p.y;
      } else {
        for (const auto& part : parts) EXPECT_FALSE(reaches(part, part.contained));
      }
    }
  }
}

TEST(Footprint, TheOutlineHasNoGaps) {
  const Footprint body = Footprint::rectangle(0.5, 0.3, 0.6);
  const std::vector<Point> points = body.outline_points(0.05);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &a = points[i], &b = points[(i + 1) % points.size()];
    EXPECT_LE(std::hypot(a.x - b.x, a.y - b.y), 0.05 + 1e-12);
    EXPECT_LT(body.distance_to_outline(a), 1e-12);
  }
}

TEST(Footprint, WithoutARimEverySideIsAsMuchNearer) {
  const Footprint long_nose = Footprint::rectangle(0.9, 0.2, 0.5), inner = long_nose.without_rim(0.06);
  EXPECT_NEAR(inner.half_width(), 0.19, 1e-12);
  EXPECT_NEAR(inner.circumscribed_radius(), std::hypot(0.84, 0.19), 1e-12);
  EXPECT_NEAR(long_nose.without_rim(1).half_width(), 0.05, 1e-12);
  EXPECT_NEAR(long_nose.without_rim(-0.06).half_width(), 0.31, 1e-12);
  RandomStream random({2, 0});
  for (int shape = 0; shape < 100; ++shape) {
    const Footprint body = random_footprint(random);
    const std::vector<Footprint> bodies = body.without_rims(0.02);
    for (std::size_t i = 1; i < bodies.size(); ++i)
      for (const Point& vertex : bodies[i].vertices()) EXPECT_TRUE(body.contains(vertex)) << shape;
  }
}

TEST(Footprint, RejectsInvalidOutlines) {
  const auto make = [](std::vector<Point> vertices) { return Footprint(vertices); };
  EXPECT_THROW(make({{1, 0}, {0, 1}}), std::invalid_argument);
  EXPECT_THROW(make({{1, 0}, {0, 1}, {std::nan(""), 0}}), std::invalid_argument);
  EXPECT_THROW(make({{1, 1}, {2, 1}, {2, 2}, {1, 2}}), std::invalid_argument);        // origin outside
  EXPECT_THROW(make({{-1, -1}, {1, 1}, {1, -1}, {-1, 1.5}}), std::invalid_argument);  // sides cross
  EXPECT_THROW(Footprint::rectangle(0.5, 0.3, 0.6).outline_points(1e-9), std::invalid_argument);
  expect_error_with<std::invalid_argument>({"vertex 1"}, [&] { make({{-1, -1}, {200, 0}, {0, 1}}); });
}

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

TEST(ScanMap, AScanTakesNoLongerThanTheMapIsWide) {
  ScanMap map(walled());
  const std::vector<double> nothing(1000, 1e300);
  for (const double most : {65533.0, 1e300, double{INFINITY}, double{NAN}})
    for (const double x : {0.01, 1e7, 1e300, double{NAN}}) {
      const testing::CallLimits limits;
      map.add({{x, 0.01, 3.14159265}, nothing, most});
      limits.check();
    }
  EXPECT_EQ(at(map, 1.55, 0.01), Occupancy::occupied);
}

TEST(ScanMap, DropsInvalidBeamsAndAllocatesNothing) {
  ScanMap map(walled());
  const std::vector<Occupancy> before = map.grid().cells;
  const std::vector<double> ranges{std::nan(""), -1, INFINITY, 0};
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
}  // namespace slalom::navigation::costmap_test
