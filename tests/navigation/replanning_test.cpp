#include <gtest/gtest.h>

#include "navigation/drive.hpp"
#include "slalom/navigation/path_planner.hpp"

/// Paths that are sent again and again, as planners do.
namespace slalom::navigation::replanning_test {
namespace {

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
}  // namespace slalom::navigation::replanning_test
