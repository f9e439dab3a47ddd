// Cars behind are expected to give way to the own car.
// The memory of obstacles that the car has passed.
#include <gtest/gtest.h>

#include <numeric>

#include "support/predicted.hpp"
#include "vehicle/planner/obstacles/cars_behind.hpp"
#include "vehicle/planner/obstacles/obstacle_memory.hpp"
#include "vehicle/planner/obstacles/pace_of_others.hpp"

namespace slalom::vehicle::detail::cars_behind_test {
namespace {

constexpr double wheelbase = 0.33;   // m
constexpr maps::Pose own{10, 2, 0};  // of the rear axle
constexpr int times = 17;            // poses of a hypothesis, 0.1 s apart
constexpr double limit = 0.2;        // of the probability of a collision, by default

/// A car whose middle is `ahead` (m) of the own rear axle, with hypotheses at these speeds (m/s) along x.
struct PredictedCar : testing::Predicted {
  PredictedCar(double ahead, const std::vector<double>& speeds, const std::vector<double>& weights,
               double yaw = 0)
      : Predicted(0.58, 0.31, hypotheses(ahead, speeds, weights, yaw), times) {}

 private:
  static std::vector<Hypothesis> hypotheses(double ahead, const std::vector<double>& speeds,
                                            const std::vector<double>& weights, double yaw) {
    std::vector<Hypothesis> made;
    for (std::size_t h = 0; h < speeds.size(); ++h)
      made.push_back({weights[h], {own.x + ahead, own.y, yaw}, speeds[h], 0.05, 0.02});
    return made;
  }
};

double sum_of(const maps::PredictedObstacle& obstacle) {
  return std::accumulate(obstacle.weights.begin(), obstacle.weights.begin() + obstacle.hypotheses, 0.0);
}

TEST(CarsBehind, BrakeAfterTheirReactionTime) {
  const PredictedCar faster(-1, {6, 5}, {0.7, 0.3});
  CarsBehind behind(wheelbase);
  const auto reacting = behind.giving_way({&faster.obstacle, 1}, own);
  ASSERT_EQ(reacting.size(), 1u);
  const maps::PredictedObstacle& car = reacting[0];
  ASSERT_EQ(car.hypotheses, 3);
  ASSERT_EQ(car.times(), 17u);
  const double start = own.x - 1;
  EXPECT_NEAR(car.at(0, 0.3).pose.x, start + 1.8, 1e-9) << "it has not reacted yet";
  EXPECT_NEAR(car.at(0, 0.8).pose.x, start + 0.8 * 6 - 0.5 * 8 * 0.5 * 0.5, 1e-9);
  EXPECT_NEAR(car.at(0, 1.6).pose.x, start + 0.3 * 6 + 6 * 6 / 16.0, 1e-9) << "it stands";
  EXPECT_NEAR(sum_of(car), 1, 1e-12);
  EXPECT_NEAR(car.weights[1] / car.weights[2], 0.7 / 0.3, 1e-9);
  EXPECT_LT(car.weights[1] + car.weights[2], limit) << "that it does not see the own car is no collision";
  EXPECT_NEAR(car.at(1, 1.5).pose.x, start + 1.5 * 6, 1e-9);
}

TEST(CarsBehind, TheLeastLikelyHypothesisGivesItsPlace) {
  const PredictedCar car(-1, {6, 5, 4, 3}, {0.4, 0.3, 0.1, 0.2});
  CarsBehind behind(wheelbase);
  const maps::PredictedObstacle reacting = behind.giving_way({&car.obstacle, 1}, own)[0];
  ASSERT_EQ(reacting.hypotheses, 4);
  EXPECT_NEAR(sum_of(reacting), 1, 1e-12);
  for (int h = 1; h < 4; ++h) EXPECT_NE(reacting.at(h, 1).pose.x, car.obstacle.at(2, 1).pose.x);
}

TEST(CarsBehind, OthersStayAsTheyAre) {
  constexpr double opposite = 3.14159;
  CarsBehind behind(wheelbase);
  for (const auto& [ahead, yaw] : {std::pair(2.0, 0.0), {-0.5 * wheelbase + 0.01, 0.0}, {-1.0, opposite}}) {
    const PredictedCar car(ahead, {3}, {1}, yaw);
    EXPECT_EQ(behind.giving_way({&car.obstacle, 1}, own).data(), &car.obstacle) << ahead << ", " << yaw;
  }
  const PredictedCar ahead(2, {3}, {1}), rear(-2, {3}, {1});
  const std::vector<maps::PredictedObstacle> both{ahead.obstacle, rear.obstacle};
  const auto reacting = behind.giving_way(both, own);
  ASSERT_EQ(reacting.size(), 2u);
  EXPECT_EQ(reacting[0].poses.data(), ahead.obstacle.poses.data());
  EXPECT_EQ(reacting[1].hypotheses, 2);
}

TEST(CarsBehind, WhatCannotBeUsedStaysAsItIs) {
  CarsBehind behind(wheelbase);
  PredictedCar car(-1, {6}, {1});
  const auto stays = [&] { return behind.giving_way({&car.obstacle, 1}, own).data() == &car.obstacle; };
  EXPECT_FALSE(stays());
  car.obstacle.hypotheses = 5;
  EXPECT_TRUE(stays());
  car.obstacle.hypotheses = 1;
  car.obstacle.interval = 0;
  EXPECT_TRUE(stays());
  car.obstacle.interval = 0.1;
  car.obstacle.poses = {};
  EXPECT_TRUE(stays());
  car.obstacle.poses = car.poses;
  car.poses[0].pose.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(stays());
  const std::vector<maps::PredictedPose> many(100, {{own.x - 1, own.y, 0}, 0, 0});
  car.obstacle.poses = many;
  EXPECT_TRUE(stays()) << "more poses than there is room for";
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

constexpr double path_speed = 4;         // m/s
constexpr double period = 0.025;         // s
constexpr double steps_behind = 2000;    // time steps
constexpr maps::Point origin{100, -50};  // m, map frame

/// A straight path along x through the origin of the field's frame.
maps::ReferenceField straight_field() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 400; ++i) path.push_back({-20 + 0.1 * i, 0, 0, path_speed});
  maps::ReferenceField field(path);
  field.update({0, 0});
  return field;
}

/// A car at a pose (m, rad, field's frame) that drives at this speed (m/s) along its yaw. A second hypothesis
/// of less weight says that it stands.
struct CarAt : testing::Predicted {
  CarAt(int id, const maps::Pose& at, double speed)
      : Predicted(0.5, 0.3,
                  {{0.7, {origin.x + at.x, origin.y + at.y, at.yaw}, speed, 0.05, 0.02},
                   {0.3, {origin.x + at.x, origin.y + at.y, at.yaw}, 0, 0.05, 0.02}},
                  4) {
    obstacle.id = id;
  }
};

/// The steps lost behind one car after it was seen for some time (s), by a car at the field's origin.
double lost_behind(const CarAt& car, double seconds, const maps::Pose& own = {0, 0, 0}) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  const maps::PredictedObstacle* const all[] = {&car.obstacle};
  double lost = 0;
  for (double t = 0; t < seconds; t += period) lost = pace.steps_lost(all, field, origin, own)[0];
  return lost;
}

TEST(PaceOfOthers, BehindASlowerCarItsShareOfTheTimeIsLost) {
  EXPECT_NEAR(lost_behind(CarAt(1, {3, 0.2, 0}, 0.9 * path_speed), 30), 0.1 * steps_behind, 1);
  EXPECT_NEAR(lost_behind(CarAt(1, {3, 0.2, 0}, 0.4 * path_speed), 30), 0.25 * steps_behind, 1);
}

TEST(PaceOfOthers, NothingIsLostBehindACarAsFastAsThePath) {
  EXPECT_NEAR(lost_behind(CarAt(1, {3, 0, 0}, path_speed), 10), 0, 1e-6);
  EXPECT_EQ(lost_behind(CarAt(1, {3, 0, 0}, 1.2 * path_speed), 10), 0);
}

TEST(PaceOfOthers, ASpeedIsBelievedOnlyAfterSomeSeconds) {
  const CarAt car(1, {3, 0, 0}, 0.8 * path_speed);
  EXPECT_LT(lost_behind(car, period), 0.01 * 0.2 * steps_behind);
  EXPECT_NEAR(lost_behind(car, 3), (1 - std::exp(-1)) * 0.2 * steps_behind, 0.02 * steps_behind);
}

TEST(PaceOfOthers, ACarThatGetsUpToSpeedHasNotShownItsPace) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  double lost = 0;
  const auto drive = [&](double seconds, auto&& speed_after) {
    for (double t = 0; t < seconds; t += period) {
      const CarAt car(1, {3, 0, 0}, speed_after(t));
      const maps::PredictedObstacle* const all[] = {&car.obstacle};
      lost = pace.steps_lost(all, field, origin, {0, 0, 0})[0];
    }
  };
  drive(1, [](double t) { return 0.5 + t * (path_speed - 0.5); });
  EXPECT_EQ(lost, 0);
  drive(20, [](double) { return 0.8 * path_speed; });
  EXPECT_NEAR(lost, 0.2 * steps_behind, 0.01 * steps_behind) << "then it has";
}

TEST(PaceOfOthers, CarsThatAreNotFollowedCostNothing) {
  const double slow = 0.5 * path_speed;
  EXPECT_EQ(lost_behind(CarAt(1, {-2, 0, 0}, slow), 10), 0) << "behind";
  EXPECT_EQ(lost_behind(CarAt(1, {12, 0, 0}, slow), 10), 0) << "far ahead";
  EXPECT_EQ(lost_behind(CarAt(1, {3, 4, 0}, slow), 10), 0) << "far to the side";
  EXPECT_EQ(lost_behind(CarAt(1, {3, 0, 3}, slow), 10), 0) << "oncoming";
  EXPECT_EQ(lost_behind(CarAt(1, {3, 0, 0}, slow), 10, {0, 0, 2}), 0) << "the own car turns away";
  EXPECT_GT(lost_behind(CarAt(1, {3, 0, 0}, slow), 10), 0);
}

TEST(PaceOfOthers, EveryCarIsRememberedByItself) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  const CarAt slow(1, {3, 0, 0}, 0.8 * path_speed), fast(2, {5, 0, 0}, path_speed);
  const maps::PredictedObstacle* const both[] = {&slow.obstacle, &fast.obstacle};
  const maps::PredictedObstacle* const swapped[] = {&fast.obstacle, &slow.obstacle};
  for (int i = 0; i < 1200; ++i) pace.steps_lost(both, field, origin, {0, 0, 0});
  const auto lost = pace.steps_lost(swapped, field, origin, {0, 0, 0});
  EXPECT_NEAR(lost[0], 0, 1e-6);
  EXPECT_NEAR(lost[1], 0.2 * steps_behind, 1);
  pace.reset();
  EXPECT_LT(pace.steps_lost(swapped, field, origin, {0, 0, 0})[1], 0.01 * steps_behind);
}

TEST(PaceOfOthers, TheCarSeenLongestAgoGivesItsPlaceToANewOne) {
  const maps::ReferenceField field = straight_field();
  PaceOfOthers pace(steps_behind, period, {});
  const CarAt kept(1, {3, 0, 0}, 0.8 * path_speed);
  const maps::PredictedObstacle* const one[] = {&kept.obstacle};
  for (int i = 0; i < 1200; ++i) pace.steps_lost(one, field, origin, {0, 0, 0});
  for (int id = 2; id < 60; ++id) {
    const CarAt other(id, {4, 0, 0}, path_speed);
    const maps::PredictedObstacle* const both[] = {&other.obstacle, &kept.obstacle};
    EXPECT_NEAR(pace.steps_lost(both, field, origin, {0, 0, 0})[1], 0.2 * steps_behind, 1) << id;
  }
}

}  // namespace

}  // namespace slalom::vehicle::detail::cars_behind_test
