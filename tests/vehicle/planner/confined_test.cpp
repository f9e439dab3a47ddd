// A car that stands a millimetre outside of its margin, where every way out begins inside of it.
#include <gtest/gtest.h>

#include "vehicle/planner/lane_scan.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::vehicle {
namespace {

constexpr double period = 0.025;  // s
// m, in the car's frame: the side of a box to the left of its rear.
const testing::LaneScan beside_box({{{0.048, 0.232}, {0.288, 0.782}}}, 1081);

TEST(Confined, ACarThatCanMoveNeitherWayOutsideOfItsMarginKeepsLessOfIt) {
  VehicleOptions car;
  car.body = {
      .front = 0.461, .rear = 0.119, .width = 0.31, .margin = 0.05, .soft_margin = 0.25, .soft_cost = 20};
  Planner planner = testing::sliding_planner({}, car);
  const PlannerInput input{beside_box.view(), {{5, 0, 0}, 0}};
  double highest = 0, time = 0;
  for (; time < 2 && highest < 0.2; time += period) highest = planner.update(input).command.speed;
  EXPECT_GT(highest, 0.2);
}

}  // namespace
}  // namespace slalom::vehicle
