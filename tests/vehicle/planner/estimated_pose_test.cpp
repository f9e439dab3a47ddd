// A planner whose pose is an estimate with a covariance, and what it predicts of other sequences.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "vehicle/planner/planner_calls.hpp"

namespace slalom::vehicle {
namespace {

constexpr double speed = 3, period = 0.025;         // m/s, s
constexpr double wall = 0.5, spacing = 4.7 / 1080;  // m to the left of the car's axis; rad
constexpr double position_error = -0.25;            // m, to the right
const std::vector<float> straight_on(2 * 6, 0);     // six steps without steering and acceleration

Planner make_planner() {
  VehicleOptions car;
  car.model = vehicle_model("single_track");
  car.hold_first_input = false;
  PlannerOptions options;
  options.control_period = period;
  return {options, make_vehicle_model(car), testing::lane(speed),
          make_solver(testing::few_samples("svg_mppi"), 2)};
}

/// The ranges that a laser on the axis of a car along x measures to a wall to its left.
std::vector<float> beside_a_wall() {
  std::vector<float> ranges(1081);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double sine = std::sin(-2.35 + static_cast<double>(i) * spacing);
    ranges[i] = static_cast<float>(sine > 0.02 ? wall / sine : 29);
  }
  return ranges;
}

/// The collision cost of driving straight on beside the wall, after a second in which the pose was right and
/// one update in which it is wrong by `error` (m, to the left).
double cost_beside_the_wall(double error) {
  Planner planner = make_planner();
  const std::vector<float> ranges = beside_a_wall();
  PlannerInput input{{ranges, -2.35, spacing, 0.05, 30}, {{5, 0, 0}, speed}};
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
  Planner planner = make_planner();
  const std::vector<float> ranges = beside_a_wall();
  std::vector<PredictedState> states(straight_on.size() / 2 + 1);
  EXPECT_EQ(planner.predict(straight_on, states).state, 0);
  planner.update({{ranges, -2.35, spacing, 0.05, 30}, {{5, 0.2, 0}, speed}});
  EXPECT_GT(planner.predict(straight_on, states).state, 0);
  planner.reset(1);
  EXPECT_EQ(planner.predict(straight_on, states).state, 0);
}

}  // namespace
}  // namespace slalom::vehicle
