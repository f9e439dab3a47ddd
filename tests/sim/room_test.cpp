#include "slalom/sim/room/room.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "slalom/sim/room/crowd.hpp"

namespace slalom::sim::room_test {
namespace {

/// 6 x 4 m with a wall at x = 3 from y = 0 to 2, and a pallet.
const Room workshop{6, 4, {{{3, 1, 0}, 0.2, 2}}, {{{4.5, 3, 0}, 0.8, 1.2}}};

TEST(Room, TheMapShowsTheWallsAlone) {
  const maps::OccupancyGrid map = map_of(workshop, 0.05);
  EXPECT_EQ(map.width, 122);
  EXPECT_EQ(map.height, 82);
  const auto at = [&](double x, double y) {
    return map.at(static_cast<int>(std::floor((x - map.origin.x) / 0.05)),
                  static_cast<int>(std::floor((y - map.origin.y) / 0.05)));
  };
  for (const auto& [x, y] : {maps::Point{3, 1}, {2.91, 1.97}, {-0.02, 1}})
    EXPECT_EQ(at(x, y), maps::Occupancy::occupied);
  for (const auto& [x, y] : {maps::Point{2.88, 1}, {3, 2.03}, {4.5, 3}})
    EXPECT_EQ(at(x, y), maps::Occupancy::free);
  EXPECT_THROW(map_of({0.5, 4, {}, {}}, 0.05), std::invalid_argument);
  EXPECT_THROW(map_of(workshop, 0), std::invalid_argument);
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
  const auto hits = [](double x, double y, double yaw) {
    return collides(workshop, {{x, y, yaw}, 0.7, 0.5});
  };
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
  scan(workshop, {1, 1, 0}, 8, ranges);
  EXPECT_NEAR(ranges[0], 1.9, 1e-9);
  EXPECT_NEAR(ranges[1], 3, 1e-9);
  EXPECT_NEAR(ranges[2], 1, 1e-9);
  EXPECT_NEAR(ranges[3], 1, 1e-9);
  scan(workshop, {2, 3, 0}, 8, ranges);
  EXPECT_NEAR(ranges[0], 2.1, 1e-9) << "the pallet";
  scan(workshop, {1, 1, M_PI_2}, 1.5, ranges);
  EXPECT_EQ(ranges[0], 1.5) << "out of range";
  EXPECT_EQ(ranges[3], 1.5) << "the wall is out of range too";
}

constexpr double tick = 0.01;            // s
const Box far_robot{{50, 50, 0}, 1, 1};  // beyond all rooms
const Room hall{10, 4, {}, {}};

void walk(Crowd& crowd, double duration, const Box& robot = far_robot) {
  for (int i = 0; i < static_cast<int>(std::lround(duration / tick)); ++i) crowd.step(tick, robot, {});
}

TEST(Crowd, AWalkerReachesItsSpeedAndStopsAtItsLastPoint) {
  Crowd crowd(hall, {{{{1, 2}, {5, 2}, {5, 3}}, 1.2, 0.25, 0.5}});
  walk(crowd, 0.49);
  EXPECT_EQ(crowd.bodies()[0].middle.x, 1) << "it waits";
  walk(crowd, 2);
  EXPECT_NEAR(std::hypot(crowd.velocities()[0].x, crowd.velocities()[0].y), 1.2, 0.05);
  walk(crowd, 8);
  EXPECT_NEAR(crowd.bodies()[0].middle.x, 5, 0.25);
  EXPECT_NEAR(crowd.bodies()[0].middle.y, 3, 0.25);
  EXPECT_LT(std::hypot(crowd.velocities()[0].x, crowd.velocities()[0].y), 0.05);
}

TEST(Crowd, TwoWhoMeetPassWithoutTouching) {
  Crowd crowd(hall, {{{{1, 2}, {9, 2}}, 1.2}, {{{9, 2.1}, {1, 2.1}}, 1.2}});
  double nearest = 100;
  for (int i = 0; i < 1200; ++i) {
    walk(crowd, tick);
    nearest = std::min(nearest, distance(crowd.bodies()[0].middle, crowd.bodies()[1].middle));
  }
  EXPECT_GT(nearest, 0.5) << "twice the radius";
  EXPECT_GT(crowd.bodies()[0].middle.x, 8.7);
  EXPECT_LT(crowd.bodies()[1].middle.x, 1.3);
}

TEST(Crowd, TheFieldOfViewIsTheSameAtTheEndOfAWay) {
  const double behind = 1.919862177193763;  // rad: 110 degrees from the way, out of view
  const maps::Point other{5 + 0.7 * std::cos(behind), 2 + 0.7 * std::sin(behind)};
  const auto pushed_aside = [&](double way) {
    Crowd crowd(hall, {{{{5, 2}, {5 + way, 2}}, 1.3}, {{other}}});
    walk(crowd, tick);
    return crowd.velocities()[0].y;
  };
  EXPECT_LT(pushed_aside(3), -0.001);
  EXPECT_DOUBLE_EQ(pushed_aside(0.3), pushed_aside(3));
}

TEST(Crowd, WalksRoundAWallThatItsWayTouches) {
  const Room room{10, 4, {{{5, 1, 0}, 0.4, 2}}, {}};
  Crowd crowd(room, {{{{1, 2.2}, {9, 2.2}}, 1}});
  double nearest = 100;
  for (int i = 0; i < 1500; ++i) {
    walk(crowd, tick);
    nearest = std::min(nearest, signed_gap(room.walls[0], crowd.bodies()[0]));
  }
  EXPECT_GT(nearest, 0);
  EXPECT_GT(crowd.bodies()[0].middle.x, 8.7);
}

TEST(Crowd, OnlyTheInattentiveWalkIntoARobotThatStands) {
  for (const bool attentive : {true, false})
    for (const double offset : {0.0, 0.1, -0.3}) {
      const Box robot{{5, 2 + offset, 0.3}, 0.7, 0.5};
      Crowd crowd(hall, {{{{1, 2}, {9, 2}}, 1.3, 0.25, 0, attentive}});
      double nearest = 100;
      for (int i = 0; i < 1000; ++i) {
        walk(crowd, tick, robot);
        nearest = std::min(nearest, signed_gap(robot, crowd.bodies()[0]));
      }
      EXPECT_EQ(nearest > 0, attentive) << offset;
    }
}

TEST(Crowd, RefusesWalkersWithoutAWayOrRoom) {
  EXPECT_THROW(Crowd(hall, {{{}}}), std::invalid_argument);
  EXPECT_THROW(Crowd(hall, {{{{0.1, 2}}}}), std::invalid_argument);
  EXPECT_THROW(Crowd(hall, {{{{1, 2}}, 4}}), std::invalid_argument);
  EXPECT_THROW(Crowd(hall, {{{{1, 2}, {NAN, 2}}}}), std::invalid_argument);
  EXPECT_THROW(Crowd({10, 4, {}, {{{1, 2, 0}, 1, 1}}}, {{{{1.7, 2}}}}), std::invalid_argument);
}

TEST(Room, PeopleAreSeenAndHit) {
  Room room = hall;
  room.people = {{{5, 2}, 0.25}};
  double range = 0;
  scan(room, {1, 2, 0}, 8, {&range, 1});
  EXPECT_NEAR(range, 3.75, 1e-12);
  EXPECT_TRUE(collides(room, {{4.41, 2, 0}, 0.7, 0.5}));
  EXPECT_FALSE(collides(room, {{4.39, 2, 0}, 0.7, 0.5}));
  EXPECT_FALSE(collides(room, {{4.46, 1.56, 0}, 0.7, 0.5})) << "a disc has no corners";
}

}  // namespace
}  // namespace slalom::sim::room_test
