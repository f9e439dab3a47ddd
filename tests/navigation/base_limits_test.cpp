#include <gtest/gtest.h>

#include "navigation/drive.hpp"
#include "slalom/core/random.hpp"

/// Limits of acceleration and braking, dead bands, and cost terms of the user's.
namespace slalom::navigation::base_limits_test {
namespace {

/// The largest rises and falls of the magnitude of a speed between two commands, per second.
struct Changes {
  double rise = 0, fall = 0;
  void add(double before, double now) {
    if (before * now < 0) return;
    const double change = (std::abs(now) - std::abs(before)) / drive_period;
    rise = std::max(rise, change);
    fall = std::max(fall, -change);
  }
};

TEST(BaseLimits, EveryAxisBrakesHarderThanItSpeedsUp) {
  Drive drive(BaseKind::omnidirectional);
  BaseOptions& base = drive.options.base;
  base.max_acceleration = 0.4;
  base.max_deceleration = 1.6;
  base.max_sideways_acceleration = 0.3;
  base.max_sideways_deceleration = 1.2;
  base.max_turn_acceleration = 1;
  base.max_turn_deceleration = 3;
  drive.restart();
  drive.start({1, 1, 1.5}, {{1, 1, 0}, {4, 1, 0}, {4, 3, 0}, {6, 4, 2}});
  Changes forward, left, turn;
  NavigationStatus status{};
  for (int i = 0; i < 800 && status != NavigationStatus::goal_reached; ++i) {
    const Velocity before = drive.command;
    status = drive.step();
    forward.add(before.forward, drive.command.forward);
    left.add(before.left, drive.command.left);
    turn.add(before.turn, drive.command.turn);
  }
  EXPECT_EQ(status, NavigationStatus::goal_reached);
  constexpr double rounding = 1e-4;
  EXPECT_NEAR(forward.rise, 0.4, rounding);
  EXPECT_LE(forward.fall, 1.6 + rounding);
  EXPECT_LE(left.rise, 0.3 + rounding);
  EXPECT_LE(left.fall, 1.2 + rounding);
  EXPECT_LE(turn.rise, 1 + rounding);
  EXPECT_LE(turn.fall, 3 + rounding);
  EXPECT_GT(std::max({forward.fall / 0.4, left.fall / 0.3, turn.fall}), 1.5) << "it uses its brakes";
}

TEST(BaseLimits, ARobotWithWeakBrakesStopsBeforeAWallThatAppears) {
  Drive drive(BaseKind::differential);
  BaseOptions& base = drive.options.base;
  base.max_forward = 1.5;
  base.max_deceleration = 0.5;
  drive.restart();
  drive.plant = [&](const Velocity& asked) {
    Velocity driven = asked;
    driven.forward = std::max(asked.forward, drive.velocity.forward - 0.5 * drive_period);
    return driven;
  };
  drive.start({1, 3, 0}, {{1, 3, 0}, {9, 3, 0}});
  while (drive.pose.x < 4) drive.step();
  EXPECT_GT(drive.velocity.forward, 1.4);
  drive.block(4 + 0.35 + 2.6, 0, 8, 6);  // 2.25 m take it to 0
  drive.drive(6);
  EXPECT_FALSE(drive.collided);
  EXPECT_NEAR(drive.velocity.forward, 0, 0.05);
}

TEST(BaseLimits, NoiseOfTheVelocityDoesNotShakeTheRobot) {
  Drive drive(BaseKind::differential);
  drive.restart_fast();
  drive.start({1, 3, 0}, {{1, 3, 0}, {9, 3, 0}});
  RandomStream random({4, 0});
  double shaking = 0;
  int last_turn = 0, turns = 0;
  NavigationStatus status = NavigationStatus::following;
  for (double time = 0; time < 30 && status != NavigationStatus::goal_reached; time += drive_period) {
    const Velocity driven = drive.velocity;
    drive.velocity = {driven.forward + 0.15 * random.normal(), 0, driven.turn + 0.15 * random.normal()};
    status = drive.step();
    shaking = std::max(shaking, std::abs(drive.command.forward - driven.forward));
    const int turn = drive.command.turn > 0.05 ? 1 : drive.command.turn < -0.05 ? -1 : 0;
    turns += turn != 0 && last_turn != 0 && turn != last_turn;
    if (turn != 0) last_turn = turn;
  }
  EXPECT_EQ(status, NavigationStatus::goal_reached);
  EXPECT_LT(shaking, 0.2) << "m/s in an update; 0.34 if plans begin at the measured velocity";
  EXPECT_LT(turns, 15) << "24 then";
}

TEST(BaseLimits, AFasterRobotBrakesToItsLimits) {
  Drive drive({.base = {.max_forward = 0.4, .max_acceleration = 0.5}}, free_grid(0, 0, 20, 4));
  drive.restart_fast();
  drive.start({2, 2, 0}, {{1, 2, 0}, {18, 2, 0}});
  drive.velocity.forward = 1.5;
  for (double last = 1.5; last > 0.41; last = drive.velocity.forward) {
    const NavigationResult result = drive.update();
    ASSERT_NEAR(drive.velocity.forward, last - 0.5 * drive_period, 1e-5);
    ASSERT_NEAR(maps::distance({result.plan[0].x, result.plan[0].y}, {result.plan[1].x, result.plan[1].y}),
                drive_period * drive.velocity.forward, 1e-4)
        << "plans begin with what is driven";
  }
}

TEST(BaseLimits, StopsAtAGoalThatIsBeyondItsPlansWhenItMustBrake) {
  Drive drive({.base = {.max_forward = 4.2, .max_turn = 1, .max_acceleration = 0.5}}, free_grid(0, 0, 50, 6),
              0.7, 0.8);
  drive.restart_fast();
  drive.start({2, 3, 0}, {{2, 3, 0}, {46, 3, 0}});
  double farthest = 0, fastest = 0;
  for (int i = 0; i < 700 && drive.step() != NavigationStatus::goal_reached; ++i) {
    farthest = std::max(farthest, drive.pose.x);
    fastest = std::max(fastest, drive.velocity.forward);
  }
  EXPECT_LT(farthest, 46.2);
  EXPECT_LT(drive.goal_distance(), 0.2);
  EXPECT_GT(fastest, 3.9);
}

TEST(BaseLimits, CommandsLeaveTheDeadBandAtOnce) {
  for (const double heading : {2.5, -1.0}) {
    Drive drive(BaseKind::differential);
    BaseOptions& base = drive.options.base;
    base.max_acceleration = 0.8;
    base.dead_band_forward = 0.1;
    base.dead_band_turn = 0.3;
    drive.restart();
    const auto outside = [](double value, double dead_band) {
      return std::abs(value) < dead_band ? 0 : value;
    };
    drive.plant = [&](const Velocity& asked) {
      return Velocity{outside(asked.forward, 0.1), 0, outside(asked.turn, 0.3)};
    };
    drive.start({1, 3, 0.2}, {{1, 3, 0}, {5, 3, 0}, {5, 3, heading}});
    int dead = 0;
    NavigationStatus status{};
    for (int i = 0; i < 600 && status != NavigationStatus::goal_reached; ++i) {
      status = drive.step();
      dead += drive.command.forward != drive.velocity.forward || drive.command.turn != drive.velocity.turn;
    }
    EXPECT_EQ(status, NavigationStatus::goal_reached);
    EXPECT_EQ(dead, 0) << "commands that the robot does not follow";
    EXPECT_LE(std::abs(maps::wrap_angle(drive.pose.yaw - heading)), drive.options.goal_angle + 1e-9);
  }
}

/// The largest y and the least speed in the middle of a straight path at y = 3.
Velocity on_the_way(Drive& drive) {
  drive.start({1, 3, 0}, {{1, 3, 0}, {9, 3, 0}});
  Velocity seen{1, 0, 0};
  while (drive.pose.x < 8) {
    drive.step();
    if (drive.pose.x > 4 && drive.pose.x < 6) {
      seen.forward = std::min(seen.forward, drive.velocity.forward);
      seen.left = std::max(seen.left, drive.pose.y - 3);
    }
  }
  return seen;
}

TEST(StateCost, ARobotKeepsToTheSideAndToTheSpeedThatItsUserWants) {
  for (const BaseKind kind : {BaseKind::differential, BaseKind::omnidirectional, BaseKind::ackermann}) {
    Drive drive(kind);
    drive.restart_fast();
    const Velocity without = on_the_way(drive);
    EXPECT_LT(without.left, 0.05);
    EXPECT_GT(without.forward, 0.45);
    int last_step = 0;
    drive.navigator->set_cost([&](const RolloutStates& at, std::span<double> costs) {
      last_step = std::max(last_step, at.step);
      for (std::size_t i = 0; i < costs.size(); ++i) {
        costs[i] += 5 * std::max(3.4 - at.y[i], 0.0);
        if (at.x[i] > 4 && at.x[i] < 6) costs[i] += 20 * std::max(at.forward[i] - 0.3, 0.0);
      }
    });
    const Velocity with = on_the_way(drive);
    EXPECT_GT(with.left, 0.25) << static_cast<int>(kind);
    EXPECT_LT(with.forward, 0.35) << static_cast<int>(kind);
    EXPECT_EQ(last_step, 55);
    drive.navigator->set_cost({});
    drive.velocity = {};
    const Velocity again = on_the_way(drive);
    EXPECT_LT(again.left, 0.05);
  }
}

}  // namespace
}  // namespace slalom::navigation::base_limits_test
