#include <gtest/gtest.h>

#include "navigation/drive.hpp"

/// Goals, headings and delays, beside the table of manoeuvres (RoomDrive.EveryManoeuvreEndsAsItShould).
namespace slalom::navigation::last_metre_test {
namespace {

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
  int waits = 0;
  for (int i = 0; i < 800 && status != NavigationStatus::stuck; ++i) {
    status = drive.step();
    waits += status == NavigationStatus::waiting;
  }
  EXPECT_EQ(status, NavigationStatus::stuck);
  EXPECT_GT(waits, 20) << "a reason to stand";
  EXPECT_FALSE(drive.collided);
}

}  // namespace
}  // namespace slalom::navigation::last_metre_test
