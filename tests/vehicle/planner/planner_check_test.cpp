#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "vehicle/planner/lane_scan.hpp"
#include "vehicle/planner/planner_calls.hpp"

/// Every command of a planner is one that a car may take, whatever its inputs.
namespace slalom::vehicle::planner_check_test {
namespace {

Planner make_planner(double max_speed) {
  PlannerOptions options{.max_speed = max_speed};
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

TEST(PlannerCheck, PathsWhosePointsNearlyCoincideAreRefusedOrDriven) {
  const auto wall = wall_around(10);
  const auto drives = [&](double radius, int points, bool closed) {
    std::vector<maps::ReferencePoint> path;
    for (double x = -20; !closed && x < 0; x += 0.1) path.push_back({x, 0, 0, 3});
    for (int i = 0; i < points; ++i) {
      const double angle = 2 * 3.14159265358979 * i / points;
      path.push_back({radius * std::cos(angle), radius * std::sin(angle), angle, 3});
    }
    try {
      Planner planner = testing::sliding_planner({}, {}, path);
      const testing::CallLimits limits;
      EXPECT_TRUE(std::isfinite(planner.update({scan_of(wall), {{0, 0, 0}, 3}}).command.steer));
      limits.check();
      return true;
    } catch (const std::invalid_argument&) {
      return false;
    }
  };
  for (const double radius : {0.0, 3e-10, 1e-3}) {
    EXPECT_FALSE(drives(radius, 100, true)) << radius;
    EXPECT_TRUE(drives(radius, 100000, false)) << radius;
  }
  EXPECT_FALSE(drives(1, 100000, true));
  for (const int points : {20, 50000}) EXPECT_TRUE(drives(1, points, true));
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

// A car that stands a millimetre outside of its margin, where every way out begins inside of it.
// m, in the car's frame: the side of a box to the left of its rear.
const testing::LaneScan beside_box({{{0.048, 0.232}, {0.288, 0.782}}}, 1081);

TEST(Confined, ACarThatCanMoveNeitherWayOutsideOfItsMarginKeepsLessOfIt) {
  VehicleOptions car;
  car.body = {
      .front = 0.461, .rear = 0.119, .width = 0.31, .margin = 0.05, .soft_margin = 0.25, .soft_cost = 20};
  Planner planner = testing::sliding_planner({}, car);
  const PlannerInput input{beside_box.view(), {{5, 0, 0}, 0}};
  double highest = 0, time = 0;
  for (; time < 2 && highest < 0.2; time += PlannerOptions().control_period)
    highest = planner.update(input).command.speed;
  EXPECT_GT(highest, 0.2);
}

constexpr double speed = 3, period = 0.025;      // m/s, s
constexpr double position_error = -0.25;         // m, to the right
const std::vector<float> straight_on(2 * 6, 0);  // six steps without steering and acceleration
// m: a wall to the left of the car.
const testing::LaneScan beside_wall({{{-25, 0.5}, {25, 0.5}}}, 1081);

/// The collision cost of driving straight on beside the wall, after a second in which the pose was right and
/// one update in which it is wrong by `error` (m, to the left).
double cost_beside_the_wall(double error) {
  Planner planner = testing::sliding_planner();
  PlannerInput input{beside_wall.view(), {{5, 0, 0}, speed}};
  const auto update = [&](double deviation) {
    for (std::size_t i = 0; i < 3; ++i) input.odometry.covariance[i][i] = deviation * deviation;
    planner.update(input);
    input.odometry.pose.x += speed * period;
  };
  for (int i = 0; i < 40; ++i) update(0.02);
  input.odometry.pose.y = error;
  update(0.3);
  std::vector<PredictedState> states(straight_on.size() / 2 + 1);
  return planner.predict(straight_on, states).collision;
}

// The filter does not follow a pose that is as uncertain, and the walls must not follow it either: the car is
// as far from them as its laser says.
TEST(EstimatedPose, DoesNotMoveTheWallsThatTheCarSees) {
  const double right = cost_beside_the_wall(0);
  EXPECT_LT(right, 1) << "the wall is far enough";
  EXPECT_NEAR(cost_beside_the_wall(position_error), right, 5);
}

TEST(PlannerPrediction, CostsNothingBeforeAPlanAndAfterAReset) {
  Planner planner = testing::sliding_planner();
  std::vector<PredictedState> states(straight_on.size() / 2 + 1);
  EXPECT_EQ(planner.predict(straight_on, states).state, 0);
  planner.update({beside_wall.view(), {{5, 0.2, 0}, speed}});
  EXPECT_GT(planner.predict(straight_on, states).state, 0);
  planner.reset(1);
  EXPECT_EQ(planner.predict(straight_on, states).state, 0);
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

}  // namespace
}  // namespace slalom::vehicle::planner_check_test
