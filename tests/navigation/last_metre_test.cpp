#include <gtest/gtest.h>

#include "navigation/drive.hpp"

/// Goals, cusps and corners.
namespace slalom::navigation {
namespace {

TEST(LastMetre, EveryBaseReachesEveryHeading) {
  for (const BaseKind kind : {BaseKind::differential, BaseKind::omnidirectional, BaseKind::ackermann})
    for (const double heading : {3.1, 2.2, -1.5}) {
      Drive drive(kind);
      drive.start({4, 3, 0}, {{4, 3, 0}, {7, 3, heading}}, 3);
      EXPECT_EQ(drive.drive(20), NavigationStatus::goal_reached) << static_cast<int>(kind) << " " << heading;
      EXPECT_LE(drive.goal_distance(), drive.options.goal_distance + 1e-9);
      EXPECT_LE(std::abs(maps::wrap_angle(drive.pose.yaw - heading)), drive.options.goal_angle + 1e-9);
      EXPECT_FALSE(drive.collided);
    }
}

TEST(LastMetre, ACarReversesIntoABayWithOneChangeOfDirection) {
  Drive drive(BaseKind::ackermann, 0.35, 0.5);
  // Along the aisle past the bay, back on an arc of 1 m radius, and straight in.
  std::vector<maps::Pose> path;
  for (double x = 1; x < 5; x += 0.1) path.push_back({x, 3, 0});
  for (double angle = 0; angle < pi / 2; angle += 0.05)
    path.push_back({5 - std::sin(angle), 2 + std::cos(angle), angle});
  for (double y = 1.95; y > 1; y -= 0.05) path.push_back({4, y, pi / 2});
  for (const double x : {2.9, 4.6}) drive.block(x, 0, x + 0.5, 2);
  drive.start({1, 3, 0}, path);
  EXPECT_EQ(drive.drive(40), NavigationStatus::goal_reached);
  EXPECT_EQ(drive.reversals, 1);
  EXPECT_FALSE(drive.collided);
}

TEST(LastMetre, TheGoalIsTheEndOfThePath) {
  Drive drive(BaseKind::differential, 0.2, 0.4);
  drive.start({1, 1, 0}, {{1, 1, 0}, {3, 1, pi / 2}, {3, 3, pi}, {1, 3, -pi / 2}, {1, 1, 0}});
  EXPECT_EQ(drive.drive(40), NavigationStatus::goal_reached);
  EXPECT_GT(drive.time, 8 / drive.options.base.max_forward);
  // Past the dock and back into it.
  drive.start({2, 1.5, 0}, {{2, 1.5, 0}, {5, 1.5, 0}, {4, 1.5, 0}});
  EXPECT_EQ(drive.drive(40), NavigationStatus::goal_reached);
  EXPECT_GT(drive.time, 4 / drive.options.base.max_forward);
}

TEST(LastMetre, RowsAreDrivenToTheirEnds) {
  Drive drive(BaseKind::differential, 0.2, 0.4);
  drive.start({1, 1, 0}, {{1, 1, 0}, {4, 1, 0}, {4, 1.6, 0}, {1, 1.6, pi}});
  double from_corner = 1, from_second = 1;
  for (int i = 0; i < 800; ++i) {
    if (drive.step() == NavigationStatus::goal_reached) break;
    from_corner = std::min(from_corner, std::hypot(drive.pose.x - 4, drive.pose.y - 1));
    from_second = std::min(from_second, std::hypot(drive.pose.x - 4, drive.pose.y - 1.6));
  }
  EXPECT_LT(from_corner, 0.1);
  EXPECT_LT(from_second, 0.1);
  EXPECT_LT(drive.goal_distance(), 0.11);
}

TEST(LastMetre, CommandsOnAnEmptyPathAreSmooth) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Drive drive(BaseKind::differential, 0.2, 0.4);
    drive.start({1, 3, 0}, {{1, 3, 0}, {9, 3, 0}}, seed);
    double aside = 0, squares = 0;
    int sign_changes = 0, side = 0;
    for (int i = 0; i < 280; ++i) {
      drive.step();
      aside = std::max(aside, std::abs(drive.pose.y - 3));
      const int now = drive.velocity.turn > 0.08 ? 1 : drive.velocity.turn < -0.08 ? -1 : 0;
      sign_changes += now != 0 && side != 0 && now != side;
      if (now != 0) side = now;
    }
    for (const double change : drive.turn_changes) squares += change * change;
    EXPECT_LT(std::sqrt(squares / 280), 0.0155);  // rad/s; it was 0.155
    EXPECT_LE(sign_changes, 3);
    EXPECT_LT(aside, 0.02);
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

TEST(LastMetre, DrivesUpToAnOccupiedGoalAndWaits) {
  Drive drive(BaseKind::differential);
  drive.block(7.8, 2.8, 8.2, 3.2);
  drive.start({1, 3, 0}, {{1, 3, 0}, {8, 3, 0}});
  EXPECT_EQ(drive.drive(18), NavigationStatus::goal_occupied);
  const double room = 7.8 - (drive.pose.x + 0.35);
  EXPECT_GT(room, drive.options.goal_room - 0.05);
  EXPECT_LT(room, drive.options.goal_room + 0.25);
  drive.grid = free_grid(0, 0, 10, 6);
  drive.costmap.update(drive.grid);
  EXPECT_EQ(drive.drive(10), NavigationStatus::goal_reached);
}

TEST(LastMetre, ADelayThatIsToldCostsItsDurationAndLittleMore) {
  double without = 0;
  for (const int periods : {0, 10}) {
    Drive drive(BaseKind::differential);
    drive.delay_periods = periods;
    drive.options.base.delay_forward = drive.options.base.delay_turn = periods * drive_period;
    drive.restart();
    drive.start({1, 3, 0}, {{1, 3, 0}, {6, 3, 0}});
    EXPECT_EQ(drive.drive(25), NavigationStatus::goal_reached);
    EXPECT_EQ(drive.reversals, 0);
    if (periods == 0) without = drive.time;
    EXPECT_LT(drive.time, without + 1);
  }
}

TEST(LastMetre, ADelayThatIsNotToldIsEstimated) {
  for (const int periods : {0, 6, 12}) {
    Drive drive(BaseKind::differential);
    drive.delay_periods = periods;
    drive.start({1, 3, 0.3}, {{1, 3, 0}, {9, 3, 0}});
    EXPECT_EQ(drive.drive(25), NavigationStatus::goal_reached);
    EXPECT_NEAR(drive.delay, periods * drive_period, 0.051);
    EXPECT_EQ(drive.reversals, 0) << periods;
  }
}

TEST(LastMetre, ADoorALittleWiderThanTheRobotIsPassed) {
  Drive drive(BaseKind::differential);
  drive.block(4.9, 0, 5.1, 2.7);
  drive.block(4.9, 3.3, 5.1, 6);
  drive.start({1, 3, 0.1}, {{1, 3, 0}, {9, 3, 0}});
  EXPECT_EQ(drive.drive(25), NavigationStatus::goal_reached);
  EXPECT_FALSE(drive.collided);
}

TEST(LastMetre, SaysThatCommandsAreIgnored) {
  Drive drive(BaseKind::differential);
  drive.told_zero = true;
  drive.start({1, 3, 0}, {{1, 3, 0}, {8, 3, 0}});
  drive.drive(1);
  EXPECT_EQ(drive.step(), NavigationStatus::commands_ignored);
}

TEST(LastMetre, ARobotThatCannotReverseTurnsRoundInACorridorAtOnce) {
  Drive drive(BaseKind::differential);
  drive.options.base.max_reverse = 0;
  drive.restart();
  drive.block(0, 0, 10, 2.55);
  drive.block(0, 3.5, 10, 6);
  drive.start({5, 3.025, 0}, {{5, 3.025, pi}, {2, 3.025, pi}});
  EXPECT_EQ(drive.drive(12), NavigationStatus::goal_reached);
  EXPECT_FALSE(drive.collided);
}

}  // namespace
}  // namespace slalom::navigation
