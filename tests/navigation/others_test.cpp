// A robot among others that move: plans meet them where they will be, the robot brakes before them, and
// waiting for them is no dead end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "navigation/grids.hpp"
#include "slalom/navigation/navigator.hpp"
#include "support/allocations.hpp"
#include "support/predicted.hpp"

namespace slalom::navigation {
namespace {

constexpr double period = 0.05, size = 0.5;  // s; m, of the other
const Footprint body = Footprint::rectangle(0.35, 0.35, 0.5);
const maps::Pose straight[] = {{1, 0, 0}, {7, 0, 0}};

/// Somebody who keeps a velocity.
struct Other {
  maps::Point at, velocity;  // m, m/s

  testing::Predicted predicted() const {
    const maps::Pose from{at.x, at.y, std::atan2(velocity.y, velocity.x)};
    return {size, size, {{1, from, std::hypot(velocity.x, velocity.y), 0.02, 0.02}}, 2};
  }
  void move() { at = {at.x + period * velocity.x, at.y + period * velocity.y}; }
};

/// A robot on an empty floor of 10 x 6 m around (5, 0), and somebody else.
struct Meeting {
  explicit Meeting(const Other& given, NavigatorOptions options = {})
      : other(given),
        grid(free_grid(0, -3, 10, 6)),
        costmap(grid.width, grid.height, grid.resolution),
        navigator(body, options, solver(), costmap) {
    costmap.update(grid);
    navigator.set_path(straight);
  }
  static SvgMppiOptions solver() {
    SvgMppiOptions made = svg_mppi_options({});
    made.samples = 512;
    made.guides.iterations = 3;
    return made;
  }
  /// Returns the least distance of the two middles until the goal or for `duration` (s), and drives on.
  double drive(double duration, bool predicts) {
    double nearest = 100;
    for (double time = 0; time < duration && status != NavigationStatus::goal_reached; time += period) {
      const testing::Predicted predicted = other.predicted();
      const auto others =
          predicts ? std::span(&predicted.obstacle, 1) : std::span<const maps::PredictedObstacle>{};
      const NavigationResult result = navigator.update(pose, velocity, costmap, period, others);
      status = result.status;
      detours += status == NavigationStatus::detour;
      velocity = result.command;
      pose = {pose.x + period * velocity.forward * std::cos(pose.yaw),
              pose.y + period * velocity.forward * std::sin(pose.yaw), pose.yaw + period * velocity.turn};
      other.move();
      nearest = std::min(nearest, std::hypot(pose.x - other.at.x, pose.y - other.at.y));
    }
    return nearest;
  }

  Other other;
  maps::OccupancyGrid grid;
  Costmap costmap;
  Navigator navigator;
  maps::Pose pose{1, 0, 0};
  Velocity velocity;
  NavigationStatus status = NavigationStatus::following;
  int detours = 0;
};

TEST(NavigatorOthers, AreMetWhereTheyWillBe) {
  // Somebody who crosses the path so that both are at (4, 0) at the same time.
  const Other crossing{{4, -2.6}, {0, 0.42}};
  EXPECT_LT(Meeting(crossing).drive(30, false), 0.5) << "the test would not show anything";
  Meeting meeting(crossing);
  EXPECT_GT(meeting.drive(30, true), 0.6);
  EXPECT_EQ(meeting.status, NavigationStatus::goal_reached);
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
  const testing::Predicted predicted = meeting.other.predicted();
  const NavigationResult result = meeting.navigator.update(meeting.pose, meeting.velocity, meeting.costmap,
                                                           period, {&predicted.obstacle, 1});
  EXPECT_EQ(result.status, NavigationStatus::braking);
  EXPECT_LT(result.command.forward, meeting.velocity.forward);
}

TEST(NavigatorOthers, TheRobotDoesNotTouchSomebodyWhoStopsBesideIt) {
  // They are expected to walk on, through the robot, and the robot may not turn into them to get away.
  for (const double x : {0.8, 1.1, 1.3}) {
    Meeting meeting({{x, 0.58}, {0, -0.75}});
    for (int i = 0; i < 20; ++i) {
      const testing::Predicted predicted = meeting.other.predicted();
      const Velocity v =
          meeting.navigator
              .update(meeting.pose, meeting.velocity, meeting.costmap, period, {&predicted.obstacle, 1})
              .command;
      meeting.velocity = v;
      maps::Pose& at = meeting.pose;
      at = {at.x + period * v.forward * std::cos(at.yaw), at.y + period * v.forward * std::sin(at.yaw),
            at.yaw + period * v.turn};
      const maps::Point seen = maps::inverse_transform(at, meeting.other.at);
      const double gap =
          std::hypot(std::max(std::abs(seen.x) - 0.35, 0.0), std::max(std::abs(seen.y) - 0.25, 0.0));
      ASSERT_GT(gap, 0.25) << x << ", update " << i;
    }
  }
}

TEST(NavigatorOthers, WaitingForThemIsNoDeadEnd) {
  // Somebody who walks up and down where the way is narrow would hold the robot for longer than this.
  NavigatorOptions options;
  options.stuck_after = 0.5;
  Meeting meeting({{2.3, 0}, {0.01, 0}}, options);
  meeting.grid = free_grid(0, -3, 10, 6);
  fill(meeting.grid, 0, 0.5, 10, 3);
  fill(meeting.grid, 0, -3, 10, -0.5);
  meeting.costmap.update(meeting.grid);
  meeting.drive(4, true);
  EXPECT_EQ(meeting.detours, 0);
  EXPECT_NE(meeting.status, NavigationStatus::blocked);
  EXPECT_LT(meeting.pose.x, 1.8);
}

TEST(NavigatorOthers, AllocateNothingInAnUpdate) {
  Meeting meeting({{4, 0}, {-0.5, 0}});
  meeting.drive(0.5, true);
  const testing::Predicted predicted = meeting.other.predicted();
  const long before = testing::allocations();
  meeting.navigator.update(meeting.pose, meeting.velocity, meeting.costmap, period, {&predicted.obstacle, 1});
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace slalom::navigation
