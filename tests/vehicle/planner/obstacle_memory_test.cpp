// The memory of obstacles that the car has passed.
#include "vehicle/planner/obstacles/obstacle_memory.hpp"

#include <gtest/gtest.h>

namespace slalom::vehicle::detail::obstacle_memory_test {
namespace {

TEST(ObstacleMemory, KnowsWhatTheCarHasPassed) {
  ObstacleMemory memory({});
  const std::vector<maps::ScanPoint> seen = {{2.0f, 0.1f}};
  memory.remember(seen, {10, 5, 0}, 0.25);
  const std::vector<float> ranges(271, 10.0f);
  const maps::LaserScanView view{ranges, -2.356, 4.712 / 270, 0.05, 30};
  EXPECT_TRUE(memory.blind_points({10, 5, 0}, {}, view).empty()) << "in sight";
  const auto behind = memory.blind_points({13.5, 5, 0}, {}, view);
  ASSERT_EQ(behind.size(), 1u);
  EXPECT_NEAR(behind[0].x, -1.5, 1e-6);
  EXPECT_NEAR(behind[0].y, 0.1, 1e-6);
  memory.reset();
  EXPECT_TRUE(memory.blind_points({13.5, 5, 0}, {}, view).empty());
}

/// By the angle of each point, for scans that cover a part of a turn, all of it, or go beyond half a turn.
TEST(ObstacleMemory, KnowsTheDirectionsThatAScanDoesNotCover) {
  std::vector<maps::ScanPoint> seen;
  for (int i = 0; i < 150; ++i)
    seen.push_back(
        {3.0f * std::cos(0.042f * static_cast<float>(i)), 3.0f * std::sin(0.042f * static_cast<float>(i))});
  const maps::Pose laser{0.1, 0.02, 0.3};
  for (const auto& [first, last] : {std::pair{-2.356, 2.356}, {-1.0, 0.4}, {-3.1, 3.14}, {0.0, 6.28}}) {
    ObstacleMemory memory({});
    memory.remember(seen, {1, 2, 0.7}, 0.25);
    const std::vector<float> ranges(201, 10.0f);
    const maps::LaserScanView view{ranges, first, (last - first) / 200, 0.05, 30};
    const maps::Pose pose{1.4, 1.8, -2.1};
    const auto blind = memory.blind_points(pose, laser, view);
    std::size_t at = 0;
    for (const maps::ScanPoint& point : seen) {
      const maps::Point here =
          maps::inverse_transform(pose, maps::transform({1, 2, 0.7}, {double(point.x), double(point.y)}));
      const double angle = maps::wrap_angle(std::atan2(here.y - laser.y, here.x - laser.x) - laser.yaw);
      if (angle >= view.angle_min && angle <= view.angle_min + 200 * view.angle_increment) continue;
      ASSERT_LT(at, blind.size()) << first << " to " << last;
      EXPECT_NEAR(blind[at].x, here.x, 1e-12);
      EXPECT_NEAR(blind[at++].y, here.y, 1e-12);
    }
    EXPECT_EQ(at, blind.size()) << first << " to " << last;
  }
}

}  // namespace
}  // namespace slalom::vehicle::detail::obstacle_memory_test
