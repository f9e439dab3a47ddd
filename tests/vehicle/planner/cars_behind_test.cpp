// Cars behind are expected to give way to the own car.
#include "vehicle/planner/obstacles/cars_behind.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "support/allocations.hpp"
#include "support/predicted.hpp"

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

}  // namespace
}  // namespace slalom::vehicle::detail::cars_behind_test
