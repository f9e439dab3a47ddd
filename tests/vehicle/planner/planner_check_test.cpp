#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "support/adversarial_tries.hpp"
#include "vehicle/planner/lane_scan.hpp"
#include "vehicle/planner/planner_calls.hpp"

/// Every command of a planner is one that a car may take, whatever its inputs.
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

TEST(PlannerCheck, BrakingStaysBelowTheLargestSpeed) {
  Planner planner = make_planner(8);
  const auto wall = wall_around(1.5F);
  const PlannerOutput& out = planner.update({scan_of(wall), {{5, 0, 0}, 150}});
  EXPECT_EQ(out.status, PlannerStatus::blocked);
  EXPECT_LE(out.command.speed, 8);
  EXPECT_EQ(out.corrections, 1);
}

/// The output after some updates of a car that drives straight on, with this yaw rate of its gyro (rad/s).
PlannerOutput after_updates(Planner& planner, int updates, std::optional<double> yaw_rate) {
  const auto wall = wall_around(10);
  PlannerInput input{.scan = scan_of(wall), .odometry = {{5, 0, 0}, 3}};
  if (yaw_rate) input.imu = ImuReading{.yaw_rate = *yaw_rate};
  PlannerOutput out;
  for (int i = 0; i < updates; ++i) {
    out = planner.update(input);
    input.odometry.pose.x += 3 * PlannerOptions().control_period;
  }
  return out;
}

TEST(PlannerCheck, ImuReadingsThatNoCarHasAreIgnored) {
  for (const double yaw_rate : {101.0, -1e6, 1e300}) {
    Planner without = testing::sliding_planner(), with = testing::sliding_planner();
    const PlannerOutput expected = after_updates(without, 5, {}), out = after_updates(with, 5, yaw_rate);
    EXPECT_EQ(out.yaw_rate_estimate, expected.yaw_rate_estimate) << yaw_rate;
    EXPECT_EQ(out.command.steer, expected.command.steer) << yaw_rate;
  }
}

TEST(PlannerCheck, AWrongGyroIsForgottenOnceItIsRight) {
  Planner planner = testing::sliding_planner();
  after_updates(planner, 200, 90);
  EXPECT_NEAR(after_updates(planner, 200, 0).yaw_rate_estimate, 0, 0.6);
}

TEST(PlannerCheck, ScansWhoseBeamsAreTurnsApartEndAmongOthers) {
  Planner planner = make_planner(8);
  const auto wall = wall_around(1.5F);
  std::vector<maps::PredictedPose> poses(2, {{7, 0, 0}, 0.1, 0.1});
  const maps::PredictedObstacle other{
      .length = 0.6, .width = 0.3, .interval = 0.1, .hypotheses = 1, .weights = {1}, .poses = poses};
  for (const double increment : {3.2, 1e3, 1e12, 1e300}) {
    PlannerInput input{.scan = scan_of(wall), .odometry = {{5, 0, 0}, 3}};
    input.scan.angle_increment = increment;
    input.others = {&other, 1};
    EXPECT_TRUE(std::isfinite(planner.update(input).command.steer)) << increment;
  }
}

TEST(PlannerCheck, APlanThatBrakesCommandsLessThanTheEstimatedSpeed) {
  Planner planner = testing::sliding_planner();
  const auto wall = wall_around(1.2F);
  PlannerOutput out;
  for (int i = 0; i < 5; ++i) out = planner.update({.scan = scan_of(wall), .odometry = {{5, 0, 0}, 3}});
  ASSERT_EQ(out.inputs_per_step, 2);
  EXPECT_LT(out.inputs[1], 0) << "3 m/s towards a wall";
  EXPECT_LT(out.command.speed, out.speed_estimate);
}

// Obstacles are those of the scan, wherever the odometry has the car.
TEST(PlannerCheck, AfterAJumpOfThePosePlansStayBetweenTheWallsOfTheScan) {
  const testing::LaneScan lane(testing::beside_lane(0.8));
  int planned = 0;
  for (const maps::Pose& jump : {maps::Pose{0.3, 0.6, 0.2}, {-2, -1.2, 0.5}, {20, 0.3, -0.4}, {0, 40, 3}}) {
    Planner planner = testing::sliding_planner();
    for (int i = 0; i < 40; ++i) {
      maps::Pose pose{5 + 0.05 * i, 0, 0};  // 2 m/s
      if (i >= 20) pose = {pose.x + jump.x, jump.y, jump.yaw};
      const PlannerOutput& out = planner.update({.scan = lane.view(), .odometry = {pose, 2}});
      if (out.status != PlannerStatus::ok && out.status != PlannerStatus::fallback_plan) {
        EXPECT_LT(out.command.speed, 2);
        continue;
      }
      ++planned;
      for (const PredictedState& state : out.predicted)
        for (const maps::Point corner : {maps::Point{0.461, 0.155}, {0.461, -0.155}, {-0.119, 0.155}})
          EXPECT_LT(std::abs(maps::transform(state.local, corner).y), 0.8) << jump.y << " update " << i;
    }
  }
  EXPECT_GT(planned, 80);
}

TEST(PlannerCheck, EveryCommandIsValidForAnyInput) {
  testing::PlannerTally tally;
  testing::try_adversaries(
      testing::repetitions(20000), tally.updates,
      [&](testing::Adversary& adversary, std::uint64_t) { testing::call_planner(adversary, 200, tally); });
  std::printf("[ calls    ] %ld updates of %ld planners (%ld more refused), %ld corrections;", tally.updates,
              tally.planners - tally.refused, tally.refused, tally.corrections);
  for (int i = 0; i < 7; ++i) std::printf(" %s %ld", name(static_cast<PlannerStatus>(i)), tally.statuses[i]);
  std::printf("\n");
  EXPECT_GT(tally.planners, 2 * tally.refused);
  for (int i = 0; i < 6; ++i) EXPECT_GT(tally.statuses[i], 0) << name(static_cast<PlannerStatus>(i));
}

}  // namespace
}  // namespace slalom::vehicle
