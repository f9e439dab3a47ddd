// A planner whose pose is an estimate with a covariance, and what it predicts of other sequences.
#include <gtest/gtest.h>

#include <vector>

#include "vehicle/planner/lane_scan.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::vehicle {
namespace {

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

}  // namespace
}  // namespace slalom::vehicle
