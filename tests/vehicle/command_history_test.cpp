#include "vehicle/planner/command_history.hpp"

#include <gtest/gtest.h>

namespace slalom::vehicle::detail::command_history_test {
namespace {

constexpr double period = 0.025, lag = 0.1, wheelbase = 0.33;

TEST(CommandHistory, WithoutDelayTheWheelsFollowTheLag) {
  CommandHistory history(period, 0, lag, wheelbase);
  history.send(0.4);
  EXPECT_NEAR(history.steer(), 0.4 * (1 - std::exp(-0.25)), 1e-12);
  history.send(0.4);
  EXPECT_NEAR(history.steer(), 0.4 * (1 - std::exp(-0.5)), 1e-12);
}

TEST(CommandHistory, WheelsBeginToTurnAfterTheDelay) {
  CommandHistory history(period, 0.04, lag, wheelbase);  // 1.6 periods
  history.send(0.4);
  EXPECT_EQ(history.steer(), 0);
  history.send(0.4);  // 0.05 s have passed: the first command has acted for 0.01 s
  EXPECT_NEAR(history.steer(), 0.4 * (1 - std::exp(-0.1)), 1e-12);
  history.send(0.4);
  EXPECT_NEAR(history.steer(), 0.4 * (1 - std::exp(-0.35)), 1e-12);
}

TEST(CommandHistory, PredictsTheStateAfterTheDelay) {
  CommandHistory history(period, 0.06, lag, wheelbase);
  for (int i = 0; i < 4; ++i) history.send(0.2);
  const VehicleStart ahead = history.lead_ahead({{1, 2, 0.5}, 3, history.steer()});
  EXPECT_NEAR(std::hypot(ahead.pose.x - 1, ahead.pose.y - 2), 3 * 0.06, 1e-3);
  // By then all that was sent from the first command on has acted: 4 periods.
  EXPECT_NEAR(ahead.steer, 0.2 * (1 - std::exp(-4 * period / lag)), 1e-12);
  EXPECT_GT(ahead.pose.yaw, 0.5);
  EXPECT_EQ(ahead.speed, 3);
}

TEST(CommandHistory, ResetForgets) {
  CommandHistory history(period, 0.06, lag, wheelbase);
  for (int i = 0; i < 9; ++i) history.send(0.2);
  history.reset();
  history.send(0);
  history.send(0);
  EXPECT_EQ(history.steer(), 0);
}

}  // namespace
}  // namespace slalom::vehicle::detail::command_history_test
