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

}  // namespace
}  // namespace slalom::navigation::replanning_test
