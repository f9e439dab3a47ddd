// The times at which the planner reverses, its memory of obstacles, and the speeds that it may plan with.
#include "vehicle/planner/recovery.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "vehicle/planner/feasible_speeds.hpp"
#include "vehicle/planner/obstacle_memory.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr double period = 0.025, length = 100;

TEST(Recovery, LeavesACarThatGetsOnAlone) {
  Recovery recovery;
  for (int k = 0; k < 4000; ++k)
    EXPECT_FALSE(recovery.update(std::fmod(0.05 * k, length), length, 2, 2, period)) << "step " << k;
}

TEST(Recovery, ReversesACarThatStandsAndDrivesOnAfterTheWayItChose) {
  Recovery recovery;
  int waited = 0;
  while (!recovery.update(7, length, 0, 2, period)) ++waited;
  EXPECT_NEAR(waited * period, 0.7, 0.05);
  double arc = 7;
  int reversed = 0;
  while (recovery.update(arc, length, -1, 2, period)) {
    arc -= period;
    ++reversed;
  }
  EXPECT_NEAR(reversed * period, 0.8, 0.05) << "at 1 m/s";
  EXPECT_FALSE(recovery.reversing());
  EXPECT_FALSE(recovery.confined());
}

TEST(Recovery, ACarThatWaitsForOneThatDrivesIsNotStuck) {
  Recovery recovery;
  for (int k = 0; k < 400; ++k) {
    EXPECT_FALSE(recovery.update(7, length, 0, 2, period, true));
    EXPECT_FALSE(recovery.leaving());
  }
  int waited = 0;
  while (!recovery.update(7, length, 0, 2, period)) ++waited;
  EXPECT_NEAR(waited * period, 0.7, 0.05) << "it is once the other has left";
}

TEST(Recovery, ReversesFurtherEachTimeUntilTheCarGetsOn) {
  Recovery recovery;
  const auto way_of_a_try = [&] {
    while (!recovery.update(7, length, 0, 2, period)) {
    }
    double way = 0;
    while (recovery.update(7 - way, length, -1, 2, period)) way += period;
    return way;
  };
  const double first = way_of_a_try(), second = way_of_a_try();
  EXPECT_NEAR(second / first, 1.6, 0.1);
  for (int k = 0; k < 200; ++k) recovery.update(7 + 0.05 * k, length, 2, 2, period);
  while (!recovery.update(17, length, 0, 2, period)) {
  }
  double way = 0;
  while (recovery.update(17 - way, length, -1, 2, period)) way += period;
  EXPECT_NEAR(way, first, 0.05);
}

TEST(Recovery, ACarThatCannotReverseIsConfinedUntilItIsPastThePlace) {
  Recovery recovery;
  while (!recovery.update(7, length, 0, 2, period)) EXPECT_FALSE(recovery.confined());
  EXPECT_FALSE(recovery.confined()) << "it reverses first";
  int blocked = 0;
  while (recovery.update(7, length, 0, 2, period)) ++blocked;
  EXPECT_NEAR(blocked * period, 0.7, 0.05) << "something stands behind it";
  EXPECT_TRUE(recovery.confined());
  double arc = 7;
  for (; recovery.confined(); arc += 0.05) EXPECT_FALSE(recovery.update(arc, length, 2, 2, period));
  EXPECT_NEAR(arc, 11, 0.1);
}

TEST(Recovery, LeavesThePathUntilTheCarIsPastThePlaceWhereItStood) {
  Recovery recovery;
  for (int k = 0; k < 40; ++k) recovery.update(6 + 0.025 * k, length, 1, 2, period);
  EXPECT_FALSE(recovery.leaving());
  for (int k = 0; k < 22; ++k) EXPECT_FALSE(recovery.update(7, length, 0, 2, period));
  EXPECT_TRUE(recovery.leaving()) << "before it reverses";
  while (!recovery.update(7, length, 0, 2, period)) {
  }
  for (double arc = 7; recovery.update(arc, length, -1, 2, period); arc -= period) {
  }
  EXPECT_TRUE(recovery.tries_again());
  double arc = 6.2;
  for (; recovery.leaving(); arc += 0.05) EXPECT_FALSE(recovery.update(arc, length, 2, 2, period));
  EXPECT_NEAR(arc, 11, 0.1);
  EXPECT_FALSE(recovery.tries_again());
}

TEST(Recovery, TriesAgainUntilTheCarIsPastThePlaceHoweverSlowlyItDrives) {
  Recovery recovery;
  while (!recovery.update(7, length, 0, 5, period)) EXPECT_FALSE(recovery.tries_again());
  EXPECT_FALSE(recovery.tries_again()) << "it reverses first";
  double arc = 7;
  for (; recovery.update(arc, length, -1, 5, period); arc -= period) {
  }
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
  ObstacleMemory memory(1);
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
    ObstacleMemory memory(1);
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

/// A closed course of two straights of 30 m and two half circles of 3 m radius, driven at 12 m/s.
std::vector<maps::ReferencePoint> oval() {
  std::vector<maps::ReferencePoint> path;
  const double pi = 3.14159265358979, radius = 3;
  for (int i = 0; i < 150; ++i) path.push_back({0.2 * i, 0, 0, 12});
  for (int i = 0; i < 47; ++i) {
    const double a = -pi / 2 + pi * i / 47;
    path.push_back({30 + radius * std::cos(a), radius + radius * std::sin(a), 0, 12});
  }
  for (int i = 0; i < 150; ++i) path.push_back({30 - 0.2 * i, 2 * radius, pi, 12});
  for (int i = 0; i < 47; ++i) {
    const double a = pi / 2 + pi * i / 47;
    path.push_back({radius * std::cos(a), radius + radius * std::sin(a), 0, 12});
  }
  return path;
}

TEST(FeasibleSpeeds, KeepToGripBrakesAndMotor) {
  const auto path = oval();
  FeasibleSpeeds speeds(path);
  EXPECT_EQ(speeds.speeds()[0], 12);
  speeds.update({.grip = 8, .acceleration = 9, .braking = 6, .delay = 0, .switch_speed = 7});
  const auto v = speeds.speeds();
  EXPECT_NEAR(v[170], std::sqrt(8.0 * 3), 0.15) << "in the middle of the curve";
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t next = (i + 1) % v.size();
    const double way = std::hypot(path[next].x - path[i].x, path[next].y - path[i].y);
    const double change = (v[next] * v[next] - v[i] * v[i]) / (2 * way);
    EXPECT_GT(change, -6.001) << "point " << i;
    EXPECT_LT(change, 8.001) << "point " << i;
    if (v[i] > 7) {
      EXPECT_LT(change, 9 * 7 / v[i] + 1e-6) << "point " << i;
    }
  }
  const std::vector<double> fast(v.begin(), v.end());
  speeds.update({.grip = 8, .acceleration = 9, .braking = 9, .braking_share = 0.6, .delay = 0});
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t next = (i + 1) % v.size();
    const double way = std::hypot(path[next].x - path[i].x, path[next].y - path[i].y);
    EXPECT_GT((v[next] * v[next] - v[i] * v[i]) / (2 * way), -0.6 * 8.001) << "point " << i;
  }
  speeds.update({.grip = 4, .acceleration = 9, .braking = 6, .delay = 0.05, .switch_speed = 7});
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_LE(speeds.speeds()[i], fast[i]);
}

}  // namespace
}  // namespace slalom::vehicle::detail
