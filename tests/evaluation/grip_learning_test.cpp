// Which grip is believed in after laps.
#include "slalom/evaluation/grip_learning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <stdexcept>

namespace slalom::evaluation {
namespace {

constexpr double length = 80, circle = 8, belief = 0.8;
constexpr int parts = 4;

/// A lap of so many seconds along the course, with the acceleration (m/s^2) that each place takes.
RacingLap lap_of(double time, const std::function<double(double)>& acceleration, double end = length) {
  RacingLap lap;
  for (double way = 0; way <= end; way += 0.25)
    lap.samples.push_back({.distance = way, .time = time * way / end, .lateral = -acceleration(way)});
  if (end < length) lap.end = RacingEnd::collision;
  return lap;
}

TEST(GripLearning, APartInsideTheCircleIsGivenMoreAndOneBeyondItLess) {
  GripLearning learning(length, 0, parts, belief, circle);
  EXPECT_EQ(learning.next(), GripBelief(parts, belief));
  EXPECT_TRUE(learning.best().empty());
  // The first part is straight: what it takes does not depend on the grip.
  learning.learn(lap_of(10, [](double way) {
    return way < 20 ? 3.0 : way < 40 ? 7.9 : way < 60 ? 7.0 : 8.2;
  }));
  const GripBelief next = learning.next();
  EXPECT_EQ(next[0], belief);
  EXPECT_NEAR(next[1], belief * 8 / 7.9, 1e-9);
  EXPECT_GT(next[2], next[1]);
  EXPECT_LT(next[2], 1.05 * belief) << "step by step";
  EXPECT_NEAR(next[3], belief * 8 / 8.2, 1e-9);
  EXPECT_EQ(learning.best(), GripBelief(parts, belief)) << "of the lap that was driven";
}

TEST(GripLearning, WhatWasTooMuchIsNotAskedForAgain) {
  GripLearning learning(length, 0, 1, belief, circle);
  learning.learn(lap_of(10, [](double) { return 8.4; }));
  for (int k = 0; k < 20; ++k) learning.learn(lap_of(10, [](double) { return 7.0; }));
  EXPECT_LT(learning.next()[0], belief);
  EXPECT_GT(learning.next()[0], 0.95 * belief);
}

TEST(GripLearning, SingleReadingsDoNotCount) {
  GripLearning learning(length, 0, 1, belief, circle);
  learning.learn(lap_of(10, [](double way) { return way == 30 ? 30.0 : 7.5; }));
  EXPECT_GT(learning.next()[0], belief);
}

TEST(GripLearning, AfterACollisionItReturnsToTheFastestLapWithLessWhereTheLapEnded) {
  GripLearning learning(length, 0, parts, belief, circle);
  learning.learn(lap_of(10, [](double) { return 7.5; }));
  const GripBelief more = learning.next();
  learning.learn(lap_of(
      5, [](double) { return 7.5; }, 50));  // in the third part
  EXPECT_EQ(learning.next()[0], belief);
  EXPECT_LT(learning.next()[1], more[1]);
  EXPECT_LT(learning.next()[2], belief);
  EXPECT_EQ(learning.next()[3], belief);
  EXPECT_EQ(learning.best(), GripBelief(parts, belief)) << "a lap that was not completed is not fast";
  learning.learn(lap_of(9, [](double) { return 6.0; }));
  EXPECT_LT(learning.next()[2], belief);
}

TEST(GripLearning, LapsThatNeverSucceedLeadToTheLeastBelief) {
  GripLearning learning(length, 0, parts, belief, circle);
  for (int k = 0; k < 30; ++k)
    learning.learn(lap_of(
        5, [](double) { return 9.0; }, 50));
  EXPECT_EQ(learning.next()[2], GripLearning::least);
  EXPECT_EQ(learning.next()[3], belief) << "where no lap came";
}

TEST(GripLearning, CountsLapsThatGainNothing) {
  GripLearning learning(length, 0, 1, belief, circle);
  for (const auto& [time, without] : {std::pair(10.0, 0), {9.5, 0}, {9.4999, 1}, {9.6, 2}, {9.3, 0}}) {
    learning.learn(lap_of(time, [](double) { return 7.0; }));
    EXPECT_EQ(learning.without_gain(), without) << time;
  }
}

TEST(GripLearning, PartsBeginAtTheFirstPointOfTheCourse) {
  GripLearning learning(length, 50, parts, belief, circle);
  learning.learn(lap_of(10, [](double way) { return way < 10 ? 9.0 : 7.0; }));
  EXPECT_LT(learning.next()[2], belief) << "from 50 to 60 m";
  for (const int part : {0, 1, 3}) EXPECT_GT(learning.next()[static_cast<std::size_t>(part)], belief) << part;
}

TEST(GripLearning, TheBeliefIsWhatPlansUse) {
  const auto plain = std::make_unique<vehicle::Configuration>();
  const vehicle::Configuration made = with_belief(*plain, {0.6, 0.8, 0.4});
  EXPECT_EQ(made.vehicle.own_of<vehicle::SingleTrackOptions>().usable_grip, 0.8);
  const auto& shares = made.planner.grip_shares.values();
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_NEAR(shares[0], 0.75, 1e-12);
  EXPECT_EQ(shares[1], 1);
  EXPECT_NEAR(shares[2], 0.5, 1e-12);
}

TEST(GripLearning, RefusesWhatMakesNoSense) {
  EXPECT_THROW(GripLearning(0, 0, 1, belief, circle), std::invalid_argument);
  EXPECT_THROW(GripLearning(length, -1, 1, belief, circle), std::invalid_argument);
  EXPECT_THROW(GripLearning(length, 0, 0, belief, circle), std::invalid_argument);
  EXPECT_THROW(GripLearning(length, 0, 1, 1.2, circle), std::invalid_argument);
  EXPECT_THROW(GripLearning(length, 0, 1, belief, 0), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::evaluation
