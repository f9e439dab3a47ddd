// Estimated poses: of the planner (world.localised), which gets the IMU, too, while servo and motor stay; and
// of the tracker (world.tracking=localised).
#include <gtest/gtest.h>

#include <numeric>

#include "evaluation/courses.hpp"

namespace slalom::evaluation {
namespace {

LapResult lap(const char* name, const LapSettings& settings, const char* place = "fox", double timeout = 0) {
  const auto whole = course(place);
  const auto environment = timeout > 0 ? timed_out_after(timeout, whole) : whole;
  return run_lap({environment, {configuration(name)}, settings}, 3);
}

TEST(LocalisedLap, ThePlannerGetsAnEstimateOfThePose) {
  const LapResult with = lap("default", {.localised = true}, "wren"), without = lap("default", {}, "wren");
  EXPECT_TRUE(with.finished);
  EXPECT_EQ(with.collisions, 0);
  EXPECT_TRUE(without.localisation.error.empty());
  ASSERT_EQ(with.localisation.error.size(), static_cast<std::size_t>(with.steps));
  EXPECT_GT(*std::min_element(with.localisation.error.begin(), with.localisation.error.end()), 0);
  // The servo and the motor are those of the simulated car, so the lap takes as long.
  EXPECT_NEAR(with.time, without.time, 0.02 * without.time);
}

TEST(LocalisedLap, TheEstimateHoldsNearTheLimitOfGrip) {
  const LapResult racing = lap("race", {.saturating_tyres = true, .localised = true});
  EXPECT_TRUE(racing.finished);
  EXPECT_EQ(racing.collisions, 0);
  const auto& errors = racing.localisation.error;
  EXPECT_LT(std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size()), 0.12);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.6F);
}

TEST(LocalisedLap, ParkedCarsThatHideWallsDoNotMoveTheEstimateElsewhere) {
  // On wren, views of two parked cars and what they leave of the walls look like those of places metres away.
  auto driver = configuration("hardware", 0);
  driver.planner.latency = 0.01;
  const LapSettings settings{.obstacles = 5, .hardware = HardwareConditions{}, .latency = 0.01};
  for (const auto& [method, seed] : {std::pair("mppi", 310), std::pair("svg_mppi", 290)}) {
    const LapResult result = run_lap({timed_out_after(8), {driver, method}, settings}, seed);
    const auto& errors = result.localisation.error;
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.5F) << method;
    EXPECT_EQ(result.localisation.blind, 0) << method;
  }
}

TEST(LocalisedLap, ItsSensorsAreThoseOfTheWorld) {
  const LapResult usual = lap("default", {.localised = true}, "wren", 1);
  const LapResult noisy = lap("default", {.range_noise = 0.05, .localised = true}, "wren", 1);
  EXPECT_NE(noisy.localisation.error, usual.localisation.error);
  const HardwareConditions real;
  LapSettings both{.hardware = real, .localised = true};
  EXPECT_EQ(lap("default", both, "wren", 1).mean_speed,
            lap("default", {.hardware = real}, "wren", 1).mean_speed);
}

TEST(TrackedLap, AnEstimatedPoseIsAsGoodAsTheTrueOne) {
  auto driver = configuration("default_kinematic", 0);
  driver.planner.predict_others = false;  // so that both laps are the same
  LapSettings settings{.opponents = 4, .range_noise = 0.02, .dropout = 0.02, .tracking = TrackingMode::exact};
  settings.opponent_speed = 0.6;
  const auto wren = course("wren");
  // In this lap the car hits another one.
  const TrackingRecord exact = run_lap({wren, {driver}, settings}, 110).tracking;
  settings.tracking = TrackingMode::localised;
  const TrackingRecord localised = run_lap({wren, {driver}, settings}, 110).tracking;
  EXPECT_GT(localised.in_view, 300);
  EXPECT_EQ(localised.in_view, exact.in_view);
  EXPECT_GT(localised.long_detected, 0.97 * exact.long_detected);
  EXPECT_LE(localised.false_objects, exact.false_objects + 1);
  // The lap depends on the instruction set: after some collisions even the true pose leaves larger errors.
  EXPECT_LT(localised.position_error, std::max(0.1, exact.position_error + 0.02));
}

}  // namespace
}  // namespace slalom::evaluation
