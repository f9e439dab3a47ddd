// The times at which the planner reverses, and its memory of obstacles.
#include "vehicle/planner/recovery.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "vehicle/planner/obstacles/obstacle_memory.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr double period = 0.025, length = 100;

TEST(Recovery, LeavesACarThatGetsOnAlone) {
  Recovery recovery;
  for (int k = 0; k < 4000; ++k)
    EXPECT_FALSE(recovery.update(std::fmod(0.05 * k, length), length, 2, 2, period)) << "step " << k;
}

/// Lets a car stand at a place (m) until it reverses. Returns for how long, s.
double waiting_time(Recovery& recovery, double arc, double free_speed = 2) {
  int waited = 0;
  while (!recovery.update(arc, length, 0, free_speed, period)) ++waited;
  return waited * period;
}

/// Lets a car reverse from a place (m) at 1 m/s. Returns how far, m.
double reversed_way(Recovery& recovery, double arc, double free_speed = 2) {
  double way = 0;
  while (recovery.update(arc - way, length, -1, free_speed, period)) way += period;
  return way;
}

TEST(Recovery, ReversesACarThatStandsAndDrivesOnAfterTheWayItChose) {
  Recovery recovery;
  EXPECT_NEAR(waiting_time(recovery, 7), 0.7, 0.05);
  EXPECT_NEAR(reversed_way(recovery, 7), 0.8, 0.05);
  EXPECT_FALSE(recovery.reversing());
  EXPECT_EQ(recovery.margin_share(), 1);
}

TEST(Recovery, ACarThatWaitsForOneThatDrivesIsNotStuck) {
  Recovery recovery;
  for (int k = 0; k < 400; ++k) {
    EXPECT_FALSE(recovery.update(7, length, 0, 2, period, true));
    EXPECT_FALSE(recovery.leaving());
  }
  EXPECT_NEAR(waiting_time(recovery, 7), 0.7, 0.05) << "it is once the other has left";
}

TEST(Recovery, ReversesFurtherEachTimeUntilTheCarGetsOn) {
  Recovery recovery;
  waiting_time(recovery, 7);
  const double first = reversed_way(recovery, 7);
  waiting_time(recovery, 7);
  EXPECT_NEAR(reversed_way(recovery, 7) / first, 1.6, 0.1);
  for (int k = 0; k < 200; ++k) recovery.update(7 + 0.05 * k, length, 2, 2, period);
  waiting_time(recovery, 17);
  EXPECT_NEAR(reversed_way(recovery, 17), first, 0.05);
}

TEST(Recovery, ACarThatCannotReverseIsConfinedUntilItIsPastThePlace) {
  Recovery recovery;
  waiting_time(recovery, 7);
  EXPECT_EQ(recovery.margin_share(), 1) << "it reverses first";
  int blocked = 0;
  while (recovery.update(7, length, 0, 2, period)) ++blocked;
  EXPECT_NEAR(blocked * period, 0.7, 0.05) << "something stands behind it";
  EXPECT_LT(recovery.margin_share(), 1);
  double arc = 7;
  for (; recovery.margin_share() < 1; arc += 0.05) EXPECT_FALSE(recovery.update(arc, length, 2, 2, period));
  EXPECT_NEAR(arc, 11, 0.1);
}

TEST(Recovery, LeavesThePathUntilTheCarIsPastThePlaceWhereItStood) {
  Recovery recovery;
  for (int k = 0; k < 40; ++k) recovery.update(6 + 0.025 * k, length, 1, 2, period);
  EXPECT_FALSE(recovery.leaving());
  for (int k = 0; k < 22; ++k) EXPECT_FALSE(recovery.update(7, length, 0, 2, period));
  EXPECT_TRUE(recovery.leaving()) << "before it reverses";
  waiting_time(recovery, 7);
  reversed_way(recovery, 7);
  EXPECT_TRUE(recovery.tries_again());
  double arc = 6.2;
  for (; recovery.leaving(); arc += 0.05) EXPECT_FALSE(recovery.update(arc, length, 2, 2, period));
  EXPECT_NEAR(arc, 11, 0.1);
  EXPECT_FALSE(recovery.tries_again());
}

TEST(Recovery, TriesAgainUntilTheCarIsPastThePlaceHoweverSlowlyItDrives) {
  Recovery recovery;
  waiting_time(recovery, 7, 5);
  EXPECT_FALSE(recovery.tries_again()) << "it reverses first";
  double arc = 7 - reversed_way(recovery, 7, 5);
  for (; recovery.tries_again(); arc += period) EXPECT_FALSE(recovery.update(arc, length, 1, 5, period));
  EXPECT_NEAR(arc, 11, 0.1);
  EXPECT_TRUE(recovery.leaving()) << "it crawls still";
}

TEST(Recovery, NoticesACarThatDrivesInCircles) {
  Recovery recovery;
  bool reversed = false;
  for (int k = 0; k < 200 && !reversed; ++k)
    reversed = recovery.update(20 + 0.4 * std::sin(0.1 * k), length, 1.5, 2, period);
  EXPECT_TRUE(reversed);
}

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
}  // namespace slalom::vehicle::detail
