// The part of the path that a scan shows, and the speed from which a car stops on it.
#include "vehicle/planner/sight.hpp"

#include <gtest/gtest.h>

#include "vehicle/planner/lane_scan.hpp"

namespace slalom::vehicle::detail::sight_test {
namespace {

constexpr double laser_x = 0.275, front = 0.46, corner = 5;  // m
constexpr double period = 0.025;                             // s

/// m, an axis-parallel box.
struct Box {
  double left, right, bottom, top;
};

/// Along x to (5, 0), then along y to (5, 10), points 0.1 m apart.
std::vector<maps::ReferencePoint> left_turn() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 50; ++i) path.push_back({0.1 * i, 0, 0, 8});
  for (int i = 0; i <= 100; ++i) path.push_back({corner, 0.1 * i, std::numbers::pi / 2, 8});
  return path;
}

/// The scan of a laser at (laser_x, 0) among boxes, whose beams cover 4.7 rad from `first` (rad) on.
testing::LaneScan scan_of(const std::vector<Box>& boxes, double first = -2.35) {
  std::vector<testing::Wall> walls;
  for (const Box& box : boxes) {
    const maps::Point a{box.left, box.bottom}, b{box.right, box.bottom}, c{box.right, box.top},
        d{box.left, box.top};
    walls.insert(walls.end(), {{a, b}, {b, c}, {c, d}, {d, a}});
  }
  return testing::LaneScan(walls, 1081, first);
}

/// Of a car that is `size` times as long as that of 1/10 scale.
Sight sight(double reach = 12, double size = 1) {
  PlannerOptions options{.control_period = period, .laser_x = laser_x, .sight_deceleration = 6};
  BodyOptions body;
  body.rear = size * (body.front + body.rear) - front;
  body.front = front;
  return {left_turn(), false, reach, options, body};
}

const Box inner_wall{-20, 4.5, 0.5, 20};
const Box parked{2.7, 3.3, -0.15, 0.15};

TEST(Sight, OfAFreePathAllIsInSight) {
  const PathInSight seen = sight().look(scan_of({}).view(), {}, 0);
  EXPECT_EQ(seen.way, PathInSight::all);
  EXPECT_EQ(seen.obstacle, PathInSight::all);
}

TEST(Sight, TheInnerWallHidesThePathBehindTheCorner) {
  // The beam past the wall's corner (4.5, 0.5) meets x = 5 at y = 0.5 (5 - 0.275) / (4.5 - 0.275) = 0.56.
  const PathInSight seen = sight().look(scan_of({inner_wall}).view(), {}, 0);
  EXPECT_NEAR(seen.way, corner + 0.56, 0.25);
  EXPECT_EQ(seen.obstacle, PathInSight::all);
  EXPECT_EQ(sight(5).look(scan_of({inner_wall}).view(), {}, 0).way, PathInSight::all) << "beyond the reach";
  const PathInSight nearer = sight().look(scan_of({inner_wall}).view(), {}, 20);
  EXPECT_NEAR(nearer.way, seen.way - 2, 1e-9) << "from the nearest point on";
}

TEST(Sight, WhatStandsOnThePathHidesNothing) {
  const PathInSight alone = sight().look(scan_of({parked}).view(), {}, 0);
  EXPECT_EQ(alone.way, PathInSight::all);
  EXPECT_NEAR(alone.obstacle, 2.9, 0.25);
  const PathInSight both = sight().look(scan_of({parked, inner_wall}).view(), {}, 0);
  EXPECT_NEAR(both.way, corner + 0.56, 0.25);
  EXPECT_EQ(both.obstacle, alone.obstacle);
  const Box beside{2.7, 3.3, 0.25, 0.4};
  EXPECT_EQ(sight().look(scan_of({beside}).view(), {}, 0).obstacle, PathInSight::all);
}

TEST(Sight, BesideThePathThatIsHiddenNothingIsKnown) {
  Sight made = sight();
  made.look(scan_of({parked}).view(), {}, 0);
  EXPECT_TRUE(made.unknown().empty());
  const PathInSight seen = made.look(scan_of({inner_wall}).view(), {1, 0, 0}, 10);
  ASSERT_FALSE(made.unknown().empty());
  int inside = 0;
  for (const maps::Point& place : made.unknown()) {  // in the frame of the car at x = 1
    const double x = place.x + 1, y = place.y;
    EXPECT_NEAR(std::abs(x - corner), 0.45, 1e-6) << x << ' ' << y;
    EXPECT_GT(y, seen.way - 4.1) << "behind what is in sight";
    EXPECT_GT(y / (x - 1 - laser_x), 0.5 / (4.5 - laser_x) * 0.9) << "the outer side is in sight for longer";
    inside += x < corner;
  }
  EXPECT_GT(inside, 50);
}

TEST(Sight, ABeamWithoutAReadingShowsAll) {
  testing::LaneScan scan = scan_of({inner_wall});
  std::fill(scan.ranges().begin(), scan.ranges().end(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(sight().look(scan.view(), {}, 0).way, PathInSight::all);
  EXPECT_EQ(sight().look({}, {}, 0).way, PathInSight::all) << "an empty scan";
}

TEST(Sight, TheFirstBeamMayPointAnyWay) {
  const PathInSight seen = sight().look(scan_of({inner_wall}).view(), {}, 0);
  EXPECT_EQ(sight().look(scan_of({inner_wall}, 2 * std::numbers::pi - 2.35).view(), {}, 0).way, seen.way);
}

TEST(Sight, WhatIsBesideTheScanIsNotInSight) {
  const testing::LaneScan left({}, 1081, 0);  // from straight ahead to the left, and not to the right
  EXPECT_EQ(sight().look(left.view(), {0, 0, -0.5}, 0).way, PathInSight::all);
  EXPECT_LT(sight().look(left.view(), {0, 0, 0.5}, 0).way, 1);
}

TEST(Sight, ACarStopsFromTheStoppingSpeed) {
  const Sight made = sight();
  for (const double way : {2.0, 5.0, 12.0}) {
    const double speed = made.stopping_speed(way);
    EXPECT_NEAR(speed * 2 * period + speed * speed / 12, way - front - 0.1, 1e-9) << way;
  }
  EXPECT_GT(made.stopping_speed(0), 0) << "it looks around the corner";
  EXPECT_TRUE(std::isinf(made.stopping_speed(PathInSight::all)));
}

TEST(Sight, ALongerCarKeepsLongerGaps) {
  const Sight small = sight(12, 1), large = sight(12, 4);
  const auto way_of = [](double speed) { return speed * 2 * period + speed * speed / 12; };
  EXPECT_NEAR(way_of(small.stopping_speed(9)) - way_of(large.stopping_speed(9)), 0.3, 1e-9);
  EXPECT_DOUBLE_EQ(large.stopping_speed(0), 2 * small.stopping_speed(0)) << "the square root of the lengths";
}

}  // namespace
}  // namespace slalom::vehicle::detail::sight_test
