// A car that stands a millimetre outside of its margin, where every way out begins inside of it.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "vehicle/planner/planner_calls.hpp"

namespace slalom::vehicle {
namespace {

constexpr double period = 0.025;                    // s
constexpr double first = -2.35, step = 4.7 / 1080;  // rad, of the beams
constexpr double laser_x = 0.275;                   // m, ahead of the rear axle
constexpr maps::Point corner{0.048, 0.232};         // m, in the car's frame: of a box to the left of its rear
constexpr maps::Point side{0.4, 0.917};             // direction of the box's side from there on

Planner make_planner() {
  VehicleOptions car;
  car.model = vehicle_model("single_track");
  car.hold_first_input = false;
  car.body = {
      .front = 0.461, .rear = 0.119, .width = 0.31, .margin = 0.05, .soft_margin = 0.25, .soft_cost = 20};
  PlannerOptions options;
  options.control_period = period;
  options.laser_x = laser_x;
  return {options, make_vehicle_model(car), testing::lane(3),
          make_solver(testing::few_samples("svg_mppi"), 2)};
}

/// The ranges that the laser measures to the side of the box, 0.6 m long, on an empty plane.
std::vector<float> beside_the_box() {
  std::vector<float> ranges(1081);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = first + static_cast<double>(i) * step, c = std::cos(angle), s = std::sin(angle);
    // laser + range (c, s) = corner + along side
    const double x = corner.x - laser_x, determinant = s * side.x - c * side.y;
    const double range = (corner.y * side.x - x * side.y) / determinant;
    const double along = (corner.y * c - x * s) / determinant;
    const bool hit = range > 0 && along >= 0 && along <= 0.6;
    ranges[i] = static_cast<float>(hit ? range : 29);
  }
  return ranges;
}

TEST(Confined, ACarThatCanMoveNeitherWayOutsideOfItsMarginKeepsLessOfIt) {
  Planner planner = make_planner();
  const std::vector<float> ranges = beside_the_box();
  const PlannerInput input{{ranges, first, step, 0.05, 30}, {{5, 0, 0}, 0}};
  double highest = 0, time = 0;
  for (; time < 1 && highest < 0.2; time += period) highest = planner.update(input).command.speed;
  EXPECT_LT(highest, 0.2) << "it stands outside of the margin, and moves through it";
  for (; time < 8 && highest < 0.2; time += period) highest = planner.update(input).command.speed;
  EXPECT_GT(highest, 0.2);
}

}  // namespace
}  // namespace slalom::vehicle
