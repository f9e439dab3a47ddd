// The placement of a plan in the frame of a costmap, and plans that are news.
#include "logic/follower_plan.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <stdexcept>

namespace slalom::nodes::follower_plan_test {
namespace {

/// A plan along the x axis of its frame, with a pose every 0.1 m.
std::vector<maps::Pose> along_x(double from, double to, double y = 0) {
  std::vector<maps::Pose> plan;
  for (int i = 0; from + 0.1 * i < to + 1e-9; ++i) plan.push_back({from + 0.1 * i, y, 0});
  return plan;
}

TEST(FollowerPlan, LiesWhereItsFrameIsInTheCostmap) {
  FollowerPlan plan;
  plan.use({{1, 0, 0}, {2, 0, 0.5}}, "map");
  const auto* const placed = plan.place({3, 4, std::numbers::pi / 2}, {3, 5, 0});
  ASSERT_NE(placed, nullptr);
  ASSERT_EQ(placed->size(), 2U);
  EXPECT_NEAR(placed->front().x, 3, 1e-9);
  EXPECT_NEAR(placed->front().y, 5, 1e-9);
  EXPECT_NEAR(placed->back().y, 6, 1e-9);
  EXPECT_NEAR(placed->back().yaw, std::numbers::pi / 2 + 0.5, 1e-9);
}

TEST(FollowerPlan, IsPlacedAgainWhenItsFrameHasMovedNotably) {
  FollowerPlan plan;
  plan.use(along_x(0, 10), "map");
  EXPECT_NE(plan.place({0, 0, 0}, {0, 0, 0}), nullptr);
  EXPECT_EQ(plan.place({0, 0, 0}, {0, 0, 0}), nullptr);
  EXPECT_EQ(plan.place({0.01, 0, 0}, {0, 0, 0}), nullptr);
  EXPECT_NE(plan.place({0.03, 0, 0}, {0, 0, 0}), nullptr) << "the whole plan has moved";
  EXPECT_NE(plan.place({0.03, 0, 0.005}, {0, 0, 0}), nullptr) << "the goal has moved by 5 cm";
  plan.forget_placement();
  EXPECT_NE(plan.place({0.03, 0, 0.005}, {0, 0, 0}), nullptr);
}

TEST(FollowerPlan, BeginsAtTheRobot) {
  FollowerPlan plan;
  plan.use(along_x(0, 10), "map");
  plan.place({0, 0, 0}, {0, 0, 0});
  for (int x = 1; x <= 6; ++x) plan.place({0, 0, 0}, {x * 1.0, 0.3, 0});
  plan.forget_placement();
  const auto* const placed = plan.place({0, 0, 0}, {6, 0.3, 0});
  ASSERT_NE(placed, nullptr);
  EXPECT_NEAR(placed->front().x, 6, 1e-6);
  EXPECT_NEAR(placed->back().x, 10, 1e-6);
}

TEST(FollowerPlan, DoesNotSkipALoopThatComesBackToTheRobot) {
  FollowerPlan plan;
  std::vector<maps::Pose> loop = along_x(0, 4);
  for (const maps::Pose& pose : along_x(0, 4, 1)) loop.push_back({4 - pose.x, 1, 0});
  for (int i = 9; i >= 1; --i) loop.push_back({0, 0.1 * i, 0});
  loop.push_back({0, 0.02, 0});
  plan.use(loop, "map");
  const auto* const placed = plan.place({0, 0, 0}, {0, 0.015, 0});
  ASSERT_NE(placed, nullptr);
  EXPECT_EQ(placed->size(), loop.size());
}

TEST(FollowerPlan, OfTheSameWayToTheSameGoalIsNoNews) {
  FollowerPlan plan;
  plan.use(along_x(0, 10), "map");
  plan.place({0, 0, 0}, {0, 0, 0});
  const auto is_news = [&](const std::vector<maps::Pose>& other, const std::string& frame) {
    plan.use(other, frame);
    return plan.place({0, 0, 0}, {0, 0, 0}) != nullptr;
  };
  std::vector<maps::Pose> from_here = along_x(2, 10, 0.02);
  from_here.back().y = 0;
  EXPECT_FALSE(is_news(from_here, "map")) << "from where the robot is now";
  EXPECT_TRUE(is_news(along_x(2, 9), "map")) << "another goal";
  EXPECT_FALSE(is_news(along_x(3, 9), "map"));
  EXPECT_TRUE(is_news(along_x(3, 9, 0.3), "map")) << "another way";
  EXPECT_TRUE(is_news(along_x(3, 9, 0.3), "odom")) << "another frame";
  std::vector<maps::Pose> turned = along_x(3, 9, 0.3);
  turned.back().yaw = 1;
  EXPECT_TRUE(is_news(turned, "odom")) << "another heading at the goal";
}

TEST(FollowerPlan, WithoutPosesOrWithOneThatIsNotFiniteChangesNothing) {
  FollowerPlan plan;
  EXPECT_THROW(plan.use({}, "map"), std::invalid_argument);
  EXPECT_TRUE(plan.empty());
  plan.use(along_x(0, 1), "map");
  EXPECT_THROW(plan.use({{0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}}, "map"),
               std::invalid_argument);
  EXPECT_THROW(plan.use({}, "map"), std::invalid_argument);
  const auto* const placed = plan.place({0, 0, 0}, {0, 0, 0});
  ASSERT_NE(placed, nullptr);
  EXPECT_EQ(placed->size(), 11U);
}

}  // namespace
}  // namespace slalom::nodes::follower_plan_test
