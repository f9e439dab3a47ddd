/// Places where a robot would stand for ever if it only followed its plans.
/// Goals, headings and delays, beside the table of manoeuvres (RoomDrive.EveryManoeuvreEndsAsItShould).
/// Paths that are sent again and again, as planners do.
#include <gtest/gtest.h>

#include "navigation/drive.hpp"
#include "slalom/navigation/path_planner.hpp"

namespace slalom::navigation::getting_on_test {
namespace {

TEST(GettingOn, DrivesPastACornerWhereItCannotTurn) {
  Drive drive({}, free_grid(0, 0, 8, 6), 0.65, 0.5);
  const maps::Point outline[] = {{0.9, 0.25}, {-0.4, 0.25}, {-0.4, -0.25}, {0.9, -0.25}};
  drive.body = Footprint(outline);
  drive.block(0, 4.6, 8, 6);
  drive.block(0, 0, 4.4, 3.4);
  drive.block(5.6, 0, 8, 4.6);
  drive.restart_fast();
  drive.start({1.2, 4, 0}, {{1.2, 4, 0}, {5, 4, 0}, {5, 1, -pi / 2}});
  EXPECT_EQ(drive.drive(30), NavigationStatus::goal_reached);
  EXPECT_FALSE(drive.collided);
}

TEST(GettingOn, TurnsWhereThereIsRoomAndReversesToAGoalBesideAWall) {
  Drive drive(BaseKind::differential);
  drive.restart_fast();
  drive.start({1.5, 3, -0.3}, {{1.5, 3, 0}, {5, 0.32, pi}});
  EXPECT_EQ(drive.drive(40), NavigationStatus::goal_reached);
  EXPECT_GT(drive.reversals, 0);
  EXPECT_FALSE(drive.collided);
}

TEST(GettingOn, ALargeRobotKeepsToItsManoeuvreBesideAWall) {
  Drive drive({.base = {.max_forward = 1.2, .max_turn = 0.8, .max_acceleration = 0.8}},
              free_grid(0, 0, 26, 16), 2.5, 2.4);
  drive.restart();
  drive.start({4, 8, -0.3}, plan_path(drive.costmap, drive.body, {4, 8, -0.3}, {16, 1.4, pi}), 2);
  EXPECT_EQ(drive.drive(45), NavigationStatus::goal_reached);
  EXPECT_FALSE(drive.collided);
}

TEST(GettingOn, ASmallSlowRobotAndALargeOnePassADoor) {
  for (const double scale : {0.4, 6.0}) {
    maps::OccupancyGrid floor = free_grid(0, 0, scale < 1 ? 6.4 : 24, scale < 1 ? 3.2 : 12);
    floor.resolution = scale < 1 ? 0.025 : 0.1;
    Drive drive({.base = {.max_forward = scale < 1 ? 0.24 : 1, .max_turn = 1}}, floor, 0.25 * scale,
                0.34 * scale);
    drive.block(4 * scale, 0, 4.2 * scale, 2.2 * scale);
    drive.block(4 * scale, 2.7 * scale, 4.2 * scale, 4 * scale);
    drive.restart_fast();
    const maps::Pose from{1.5 * scale, 1.3 * scale, 0}, goal{6.5 * scale, 2.9 * scale, 0};
    drive.start(from, plan_path(drive.costmap, drive.body, from, goal));
    EXPECT_EQ(drive.drive(60), NavigationStatus::goal_reached) << scale;
    EXPECT_FALSE(drive.collided) << scale;
  }
}

TEST(GettingOn, ASmallRobotDrivesBackFromADoorPost) {
  maps::OccupancyGrid floor = free_grid(0, 0, 10, 5);
  floor.resolution = 0.01;  // 2 m x 1 m
  Drive drive({.base = {.max_forward = 1.6, .max_acceleration = 1.158}}, floor, 0.125, 0.128);
  drive.block(1, 0, 1.1, 0.41);
  drive.block(1, 0.58, 1.1, 1);
  drive.restart();
  const maps::Pose from{0.865, 0.458, 0.115};
  drive.start(from, plan_path(drive.costmap, drive.body, from, {1.7, 0.5, 0}));
  EXPECT_EQ(drive.drive(20), NavigationStatus::goal_reached);
  EXPECT_FALSE(drive.collided);
}

TEST(GettingOn, LeavesWhatAppearsUnderItsBody) {
  // A cell under the front, one deep in the body, and a zone.
  const double places[][4] = {{3.27, 3, 3.3, 3.04}, {3.12, 3, 3.15, 3.04}, {2.4, 2.3, 3.7, 3.6}};
  for (const auto& [x0, y0, x1, y1] : places) {
    Drive drive(BaseKind::differential, 0.3, 0.6);
    drive.restart_fast();
    drive.start({3, 3, 0}, {{3, 3, 0}, {8, 3, 0}});
    drive.block(x0, y0, x1, y1);
    EXPECT_EQ(drive.drive(30), NavigationStatus::goal_reached) << x0;
  }
}

TEST(LastMetre, YawsThatAreAllTheSameDoNotCount) {
  std::vector<maps::Pose> path;
  for (double x = 8; x > 3; x -= 0.1) path.push_back({x, 3, 0});
  Drive drive(BaseKind::differential);
  drive.start({8, 3, 0}, path);
  double backward = 0;
  for (int i = 0; i < 400 && drive.step() != NavigationStatus::goal_reached; ++i)
    backward = std::max(backward, -drive.velocity.forward);
  EXPECT_LT(backward, 0.1);
  EXPECT_LT(drive.goal_distance(), 0.11);
  EXPECT_LT(std::abs(maps::wrap_angle(drive.pose.yaw)), 0.16);
}

TEST(LastMetre, ARobotThatCannotReverseDrivesEveryPathForward) {
  for (const BaseKind kind : {BaseKind::differential, BaseKind::ackermann}) {
    Drive drive(kind);
    drive.options.base.max_reverse = 0;
    drive.restart();
    drive.start({7, 3, 0.1}, {{7, 3, 0.1}, {5, 3, 0}, {3, 3, 0}, {3, 3, -2}});
    EXPECT_EQ(drive.drive(40), NavigationStatus::goal_reached) << static_cast<int>(kind);
    EXPECT_EQ(drive.reversals, 0);
  }
}

TEST(LastMetre, ARobotThatDoesNotTurnKeepsItsHeading) {
  Drive drive(BaseKind::omnidirectional);
  drive.options.base.max_turn = 0;
  drive.restart();
  drive.start({2, 2, 0.5}, {{2, 2, 0}, {5, 2, 0}, {5, 4, 2}});
  EXPECT_EQ(drive.drive(30), NavigationStatus::goal_reached);
  EXPECT_NEAR(drive.pose.yaw, 0.5, 1e-9);
}

TEST(LastMetre, SaysThatItIsStuckWithoutTheSearchForDetours) {
  Drive drive(BaseKind::differential);
  drive.options.find_detours = false;
  drive.options.stuck_after = 1;
  drive.restart();
  drive.block(4, 1, 4.5, 5);
  drive.start({2, 3, 0}, {{2, 3, 0}, {8, 3, 0}});
  NavigationStatus status{};
  for (int i = 0; i < 800 && status != NavigationStatus::stuck; ++i) status = drive.step();
  EXPECT_EQ(status, NavigationStatus::stuck);
  EXPECT_FALSE(drive.collided);
}

/// Whether a robot stands at its goal.
bool is_there(const Drive& drive, NavigationStatus status) {
  return status == NavigationStatus::goal_reached && drive.velocity.forward == 0 && drive.velocity.turn == 0;
}

TEST(Replanning, ThePathThatIsFollowedChangesNothingBitForBit) {
  const std::vector<maps::Pose> path{{2, 3, 0}, {5, 3, 0}, {5, 4, pi}};
  for (const BaseKind kind : {BaseKind::differential, BaseKind::ackermann, BaseKind::omnidirectional}) {
    Drive once(kind), again(kind);
    once.restart_fast();
    again.restart_fast();
    once.start({2, 3, 0.2}, path);
    again.start({2, 3, 0.2}, path);
    NavigationStatus status{};
    for (int i = 0; i < 600 && !is_there(once, status); ++i) {
      again.navigator->set_path(path);
      status = once.step();
      ASSERT_EQ(again.step(), status) << i;
      ASSERT_EQ(again.velocity.forward, once.velocity.forward) << i;
      ASSERT_EQ(again.velocity.turn, once.velocity.turn) << i;
    }
    EXPECT_EQ(status, NavigationStatus::goal_reached);
  }
}

TEST(Replanning, AHeadingThatIsAskedForOnTheWayIsTakenUnlessItsPlaceIsClosed) {
  const auto path = [](double yaw) {
    return std::vector<maps::Pose>{{2, 3, 0}, {5, 3, 0}, {5, 3, yaw}, {8, 3, 0}};
  };
  for (const BaseKind kind : {BaseKind::differential, BaseKind::omnidirectional, BaseKind::ackermann})
    for (const bool closed : {false, true}) {
      Drive drive(kind);
      drive.restart_fast();
      drive.start({2, 3, 0}, path(1.5));
      drive.navigator->set_path(path(-1.5));  // another heading is another path
      if (closed) drive.block(4.9, 2.9, 5.1, 3.1);
      double least = 1;
      for (int i = 0; i < 1000 && !is_there(drive, drive.step()); ++i)
        if (std::hypot(drive.pose.x - 5, drive.pose.y - 3) < 0.11)
          least = std::min(least, std::abs(maps::wrap_angle(drive.pose.yaw + 1.5)));
      EXPECT_EQ(least < 0.16, !closed) << enum_names(kind)[static_cast<int>(kind)] << ", " << least;
      EXPECT_LT(drive.goal_distance(), 0.1) << enum_names(kind)[static_cast<int>(kind)];
      EXPECT_FALSE(drive.collided);
    }
}

TEST(Replanning, ARobotThatTurnsAtItsGoalIsThereAsSoonWithNewPaths) {
  const maps::Pose goal{6, 3, pi};
  double alone = 0;
  for (const int periods : {0, 20, 4}) {  // between paths
    Drive drive(BaseKind::differential);
    drive.restart_fast();
    drive.start({2, 3, 0}, {{2, 3, 0}, goal});
    NavigationStatus status{};
    int i = 0;
    for (; i < 800 && !is_there(drive, status); ++i) {
      if (periods > 0 && i % periods == 0)
        drive.navigator->set_path(plan_path(drive.costmap, drive.body, drive.pose, goal));
      status = drive.step();
    }
    EXPECT_EQ(status, NavigationStatus::goal_reached) << periods;
    EXPECT_EQ(drive.reversals, 0) << periods;
    if (periods == 0) alone = i;
    EXPECT_LT(i, alone + 10) << periods;
  }
}

TEST(Replanning, ACarDrivesAManoeuvreToItsEndAndKeepsItsTurningRadius) {
  for (const double heading : {1.57, pi}) {
    Drive car({.base = {.kind = BaseKind::ackermann, .max_forward = 1.5, .min_turning_radius = 1}},
              free_grid(0, 0, 14, 8));
    car.restart_fast();
    const maps::Pose goal{11, 4, heading};
    car.start({2, 4, 0}, {{2, 4, 0}, goal});
    NavigationStatus status{};
    for (int i = 0; i < 500 && status != NavigationStatus::goal_reached; ++i) {
      if (i % 10 == 0) car.navigator->set_path(plan_path(car.costmap, car.body, car.pose, goal));
      status = car.step();
      EXPECT_LE(std::abs(car.velocity.turn), std::abs(car.velocity.forward) + 1e-6) << "radius 1 m";
    }
    EXPECT_EQ(status, NavigationStatus::goal_reached) << heading;
    EXPECT_LE(car.reversals, 4) << heading;
  }
}

TEST(Replanning, AfterADetourThePathIsFollowedInOrder) {
  Drive drive(BaseKind::differential);
  drive.block(4, 1.6, 4.4, 2.2);
  drive.restart_fast();
  drive.start({1, 2, 0}, {{1, 2, 0}, {8, 2, 0}, {8, 2.6, pi}, {1, 2.6, pi}});
  double farthest = 0;
  for (int i = 0; i < 900 && drive.step() != NavigationStatus::goal_reached; ++i)
    farthest = std::max(farthest, drive.pose.x);
  EXPECT_LT(drive.goal_distance(), 0.11);
  EXPECT_GT(farthest, 7.9);
  EXPECT_FALSE(drive.collided);
}

}  // namespace

}  // namespace slalom::navigation::getting_on_test
