#include <gtest/gtest.h>

#include "navigation/drive.hpp"
#include "slalom/navigation/path_planner.hpp"

/// Places where a robot would stand for ever if it only followed its plans.
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

TEST(GettingOn, LeavesACellUnderItsBody) {
  for (const double x : {3.27, 3.12}) {  // under the front, and deep in the body
    Drive drive(BaseKind::differential, 0.3, 0.6);
    drive.block(x, 3, x + 0.03, 3.04);
    drive.restart_fast();
    drive.start({3, 3, 0}, {{3, 3, 0}, {8, 3, 0}});
    EXPECT_EQ(drive.drive(30), NavigationStatus::goal_reached) << x;
  }
}

TEST(GettingOn, LeavesAZoneThatIsSwitchedOnOverIt) {
  Drive drive(BaseKind::differential);
  drive.restart_fast();
  drive.start({3, 3, 0}, {{3, 3, 0}, {8, 3, 0}});
  drive.block(2.4, 2.3, 3.7, 3.6);
  EXPECT_EQ(drive.drive(30), NavigationStatus::goal_reached);
}

}  // namespace
}  // namespace slalom::navigation::getting_on_test
