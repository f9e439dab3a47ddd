// A robot among others that move: plans meet them where they will be, the robot brakes before them, and
// waiting for them is no dead end.
#include <gtest/gtest.h>

#include "navigation/drive.hpp"
#include "support/allocations.hpp"
#include "support/predicted.hpp"

namespace slalom::navigation::others_test {
namespace {

constexpr double size = 0.5;  // m, of the other

/// Somebody who keeps a velocity.
struct Other {
  maps::Point at, velocity;  // m, m/s

  testing::Predicted predicted() const {
    const maps::Pose from{at.x, at.y, std::atan2(velocity.y, velocity.x)};
    return {size, size, {{1, from, std::hypot(velocity.x, velocity.y), 0.02, 0.02}}, 2};
  }
  void move() { at = {at.x + drive_period * velocity.x, at.y + drive_period * velocity.y}; }
};

/// A robot on an empty floor of 10 x 6 m around (5, 0), and somebody else.
struct Meeting : Drive {
  explicit Meeting(const Other& given, const NavigatorOptions& chosen = {})
      : Drive(chosen, free_grid(0, -3, 10, 6)), other(given) {
    restart_fast();
    start({1, 0, 0}, {{1, 0, 0}, {7, 0, 0}});
  }
  /// Drives a step among the other, who does not move meanwhile.
  NavigationResult step() {
    const testing::Predicted predicted = other.predicted();
    return update({&predicted.obstacle, 1});
  }
  /// Returns the least distance of the two middles until the goal or for `duration` (s), and drives on.
  double drive(double duration, bool predicts) {
    const maps::OccupancyGrid floor = grid;
    double nearest = 100;
    for (time = 0; time < duration && status != NavigationStatus::goal_reached; time += drive_period) {
      if (is_in_costmap) {
        grid = floor;
        block(other.at.x - 0.2, other.at.y - 0.2, other.at.x + 0.2, other.at.y + 0.2);
      }
      status = (predicts ? step() : update()).status;
      detours += status == NavigationStatus::detour;
      waits += status == NavigationStatus::waiting;
      other.move();
      nearest = std::min(nearest, std::hypot(pose.x - other.at.x, pose.y - other.at.y));
    }
    return nearest;
  }

  Other other;
  NavigationStatus status = NavigationStatus::following;
  int detours = 0, waits = 0;  // updates with that status
  bool is_in_costmap = false;
};

TEST(NavigatorOthers, AreMetWhereTheyWillBe) {
  // Somebody who crosses the path so that both are at (4, 0) at the same time.
  const Other crossing{{4, -2.6}, {0, 0.42}};
  EXPECT_LT(Meeting(crossing).drive(30, false), 0.5) << "the test would not show anything";
  Meeting meeting(crossing);
  EXPECT_GT(meeting.drive(30, true), 0.6);
  EXPECT_EQ(meeting.status, NavigationStatus::goal_reached);
}

TEST(NavigatorOthers, AreSeenToMoveIfOnlyTheCostmapShowsThem) {
  for (const Other& other : {Other{{4.6, -2.6}, {0, 0.6}}, {{5.2, 2.8}, {0, -0.6}}, {{9, 0.1}, {-0.8, 0}}}) {
    Meeting meeting(other);
    meeting.is_in_costmap = true;
    EXPECT_GT(meeting.drive(30, false), 0.5) << other.at.x << ", " << other.at.y;
    EXPECT_EQ(meeting.status, NavigationStatus::goal_reached);
  }
}

TEST(NavigatorOthers, SomebodyWhoWalksTowardsTheRobotIsPassed) {
  Meeting meeting({{8, 0.05}, {-0.6, 0}});
  EXPECT_GT(meeting.drive(30, true), 0.55);
  EXPECT_EQ(meeting.status, NavigationStatus::goal_reached);
}

TEST(NavigatorOthers, TheRobotBrakesBeforeWhatIsTooNear) {
  Meeting meeting({{30, 0}, {0, 0}});
  meeting.drive(2, true);
  EXPECT_GT(meeting.velocity.forward, 0.4);
  // Ahead of its front, and coming fast: no plan avoids it.
  meeting.other = {{meeting.pose.x + 1.0, meeting.pose.y}, {-2, 0}};
  const double before = meeting.velocity.forward;
  EXPECT_EQ(meeting.step().status, NavigationStatus::braking);
  EXPECT_LT(meeting.velocity.forward, before);
}

TEST(NavigatorOthers, TheRobotPlansAgainAsOftenAsItIsToldBeforeItBrakes) {
  const auto solves = [](int retries) {
    NavigatorOptions options{.retries = retries};
    Meeting meeting({{30, 0}, {0, 0}}, options);
    meeting.drive(2, true);
    meeting.other = {{meeting.pose.x + 1.0, meeting.pose.y}, {-2, 0}};  // no plan avoids it
    int count = 0;
    meeting.navigator->set_cost(
        [&](const RolloutStates& states, std::span<double>) { count += states.step == 0; });
    EXPECT_EQ(meeting.step().status, NavigationStatus::braking);
    return count;
  };
  const int once = solves(0);
  EXPECT_GE(once, 1);
  EXPECT_EQ(solves(3), 4 * once);
}

TEST(NavigatorOthers, TheRobotDoesNotTouchSomebodyWhoStopsBesideIt) {
  // They are expected to walk on, through the robot, and the robot may not turn into them to get away.
  for (const double x : {0.8, 1.1, 1.3}) {
    Meeting meeting({{x, 0.58}, {0, -0.75}});
    for (int i = 0; i < 20; ++i) {
      meeting.step();
      const maps::Point seen = maps::inverse_transform(meeting.pose, meeting.other.at);
      const double gap =
          std::hypot(std::max(std::abs(seen.x) - 0.35, 0.0), std::max(std::abs(seen.y) - 0.25, 0.0));
      ASSERT_GT(gap, 0.25) << x << ", update " << i;
    }
  }
}

TEST(NavigatorOthers, WaitingForThemIsNoDeadEnd) {
  // Somebody who walks up and down where the way is narrow would hold the robot for longer than this.
  NavigatorOptions options{.stuck_after = 0.5};
  Meeting meeting({{2.3, 0}, {0.01, 0}}, options);
  meeting.block(0, 0.5, 10, 3);
  meeting.block(0, -3, 10, -0.5);
  meeting.drive(6, true);
  EXPECT_EQ(meeting.detours, 0);
  EXPECT_GT(meeting.waits, 80) << "of 120 updates";
  EXPECT_LT(meeting.pose.x, 1.8);
}

TEST(NavigatorOthers, AllocateNothingInAnUpdate) {
  Meeting meeting({{4, 0}, {-0.5, 0}});
  meeting.drive(0.5, true);
  const testing::Predicted predicted = meeting.other.predicted();
  const long before = testing::allocations();
  meeting.navigator->update(meeting.pose, meeting.velocity, meeting.costmap, drive_period,
                            {&predicted.obstacle, 1});
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace slalom::navigation::others_test
