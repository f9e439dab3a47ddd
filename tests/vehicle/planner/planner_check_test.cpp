#include <gtest/gtest.h>

#include <vector>

#include "support/repetitions.hpp"
#include "vehicle/planner/planner_calls.hpp"

/// What leaves a planner is a command that a car may take, whatever enters it.
namespace slalom::vehicle {
namespace {

Planner make_planner(double max_speed) {
  PlannerOptions options;
  options.max_speed = max_speed;
  return {options, make_vehicle_model({}), testing::lane(3),
          make_solver(testing::few_samples("svg_mppi"), 1)};
}

/// A wall all round the car, `distance` m away.
std::vector<float> wall_around(float distance) {
  return std::vector<float>(271, distance);
}
maps::LaserScanView scan_of(const std::vector<float>& ranges) {
  return {ranges, -2.35, 4.7 / 270, 0.05, 30};
}

TEST(PlannerCheck, ASpeedThatNoCarHasIsNotTaken) {
  Planner planner = make_planner(8);
  const auto wall = wall_around(1.5F);
  for (const double speed : {4132.0, -4132.0, 1e300}) {
    const PlannerOutput& out = planner.update({scan_of(wall), {{5, 0, 0}, speed}});
    EXPECT_EQ(out.status, PlannerStatus::bad_odometry) << speed;
    EXPECT_EQ(out.command.speed, 0) << speed;
  }
  for (const double far : {1.1e7, -1e300}) {
    EXPECT_EQ(planner.update({scan_of(wall), {{far, 0, 0}, 1}}).status, PlannerStatus::bad_odometry) << far;
    EXPECT_EQ(planner.update({scan_of(wall), {{0, far, 0}, 1}}).status, PlannerStatus::bad_odometry) << far;
    EXPECT_EQ(planner.update({scan_of(wall), {{0, 0, far}, 1}}).status, PlannerStatus::bad_odometry) << far;
  }
}

TEST(PlannerCheck, BrakingStaysBelowTheLargestSpeed) {
  Planner planner = make_planner(8);
  const auto wall = wall_around(1.5F);
  const PlannerOutput& out = planner.update({scan_of(wall), {{5, 0, 0}, 150}});
  EXPECT_EQ(out.status, PlannerStatus::blocked);
  EXPECT_LE(out.command.speed, 8);
  EXPECT_EQ(out.corrections, 1);
}

TEST(PlannerCheck, EveryCommandIsValidForAnyInput) {
  const long calls = testing::repetitions(20000);
  testing::PlannerTally tally;
  for (std::uint64_t seed = 0; tally.updates < calls; ++seed) {
    testing::Adversary adversary(seed);
    try {
      testing::call_planner(adversary, 200, tally);
    } catch (const testing::Finding& finding) {
      FAIL() << "seed " << seed << ": " << finding.what();
    }
  }
  std::printf("[ calls    ] %ld updates, %ld corrections;", tally.updates, tally.corrections);
  for (int i = 0; i < 7; ++i) std::printf(" %s %ld", name(static_cast<PlannerStatus>(i)), tally.statuses[i]);
  std::printf("\n");
  for (int i = 0; i < 6; ++i) EXPECT_GT(tally.statuses[i], 0) << name(static_cast<PlannerStatus>(i));
}

}  // namespace
}  // namespace slalom::vehicle
