// Plans beside the path, and what the cost of a plan says about its end.
#include "vehicle/planner/ways_around.hpp"

#include <gtest/gtest.h>

#include "slalom/core/option_access.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/vehicle/model/vehicle_model.hpp"
#include "support/lane.hpp"

namespace slalom::vehicle::detail::ways_around_test {
namespace {

constexpr int horizon = 28;

/// A car on a straight course at x = 10 m; `ahead` (m) of it a wall of points from `right` to `left` (m).
class Lane {
 public:
  Lane(double ahead, double right, double left)
      : field_(testing::lane(5)), model_(make_vehicle_model(car())) {
    std::vector<maps::Point> points;
    for (double y = right; y <= left; y += 0.04) points.push_back({ahead, y});
    clearance_.add(points);
    field_.update({10, 0});
    model_->set_maps({field_.view(), clearance_.view(), {10, 0, 0}});
  }

  VehicleModel& standing_at(double speed) {
    start_ = {{10, 0, 0}, speed};
    model_->set_start(start_, 5);
    return *model_;
  }
  /// The prediction of these inputs, [step][input].
  PredictedCost predict(std::span<const float> inputs) {
    states_.resize(horizon + 1);
    return model_->predict(inputs, states_);
  }
  const PredictedState& end() const { return states_.back(); }

  /// The prediction of the cheapest way around, for a car that begins at this speed (m/s).
  PredictedCost cheapest_way(double speed) {
    standing_at(speed);
    WaysAround around(testing::lane(5), true, horizon, 2, model_->traits(), 0.42);
    const std::vector<double> speeds(600, 5.0);
    around.draw(start_, 100, speeds, 1.0);
    return predict(around.cheapest(model_->evaluator()));
  }

  static VehicleOptions car() {
    VehicleOptions options;
    options.model = vehicle_model("single_track");
    options.body.model = BodyModel::discs;
    options.cost.speed_weight = 3;
    options.max_acceleration = options.max_deceleration = 9;
    return options;
  }

 private:
  maps::ReferenceField field_;
  maps::ClearanceMap clearance_;
  std::unique_ptr<VehicleModel> model_;
  VehicleStart start_;
  std::vector<PredictedState> states_;
};

std::vector<float> inputs_of(float steering, float acceleration) {
  std::vector<float> made;
  for (int k = 0; k < horizon; ++k) made.insert(made.end(), {steering, acceleration});
  return made;
}

TEST(WaysAround, PassAnObstacleOnThePathWhereThereIsRoom) {
  for (const double side : {-1.0, 1.0}) {
    Lane lane(2.0, side > 0 ? -3 : -0.2, side > 0 ? 0.2 : 3);
    lane.standing_at(0);
    const PredictedCost standing = lane.predict(inputs_of(0, -9)), way = lane.cheapest_way(0);
    EXPECT_FALSE(way.collided);
    EXPECT_LT(way.state + way.collision, standing.state + standing.collision);
    EXPECT_GT(lane.end().pose.x, 12.5) << "past the obstacle";
    EXPECT_GT(side * lane.end().pose.y, 0.3);
  }
}

TEST(WaysAround, AllCollideWhereThereIsNoRoom) {
  EXPECT_TRUE(Lane(2.2, -4, 4).cheapest_way(3).collided) << "each of them drives";
}

TEST(WaysAround, FollowThePathAtItsSpeedWhereItIsFree) {
  Lane lane(5.0, 2, 3);
  EXPECT_LT(std::abs(lane.cheapest_way(2).distance), 0.3) << "the map has cells of 0.1 m";
  EXPECT_NEAR(lane.end().speed, 5, 0.3);
  EXPECT_NEAR(lane.end().pose.y, 0, 0.05);
}

/// On a circle, across the end of its path, while the car slows down and looks less far ahead.
TEST(WaysAround, FollowACircleAcrossTheEndOfItsPath) {
  constexpr double radius = 5;
  std::vector<maps::ReferencePoint> circle;
  for (int i = 0; i < 300; ++i) {
    const double turn = 2 * std::numbers::pi * i / 300;
    circle.push_back({radius * std::cos(turn), radius * std::sin(turn), turn + std::numbers::pi / 2, 3});
  }
  maps::ReferenceField field(circle);
  maps::ClearanceMap clearance;
  const auto model = make_vehicle_model(Lane::car());
  const double turn = 2 * std::numbers::pi * 290 / 300;
  const VehicleStart start{{circle[290].x, circle[290].y, circle[290].yaw}, 4};
  field.update({start.pose.x, start.pose.y});
  model->set_maps({field.view(), clearance.view(), start.pose});
  model->set_start(start, 3);
  WaysAround around(circle, true, horizon, 2, model->traits(), 0.42);
  for (const double speed : {2.0, 4.0}) {
    const std::vector<double> speeds(300, speed);
    around.draw(start, 290, speeds, 1.0);
    std::vector<PredictedState> states(horizon + 1);
    EXPECT_FALSE(model->predict(around.cheapest(model->evaluator()), states).collided);
    for (const PredictedState& s : states)
      EXPECT_NEAR(std::hypot(s.pose.x, s.pose.y), radius, 0.15) << "at " << speed << " m/s";
    const double gone = maps::wrap_angle(std::atan2(states.back().pose.y, states.back().pose.x) - turn);
    EXPECT_GT(gone, 0.4) << "past the first point";
  }
}

/// The same plan, with and without a wall that begins beyond its end.
TEST(SingleTrackCost, EndsOnlyWhereTheCarCanStop) {
  const auto cost_of = [](double ahead, double speed) {
    Lane lane(ahead, -3, 3);
    lane.standing_at(speed);
    const PredictedCost cost = lane.predict(inputs_of(0, 0));
    EXPECT_FALSE(cost.collided);
    return cost.state + cost.collision;
  };
  const double way = 1.4 * 3;  // m, in the horizon at 3 m/s
  EXPECT_GT(cost_of(way + 0.8, 3), cost_of(7.5, 3) + 20);
  EXPECT_GT(cost_of(way + 0.8, 3), cost_of(way + 1.1, 3)) << "the nearer, the faster the collision";
  EXPECT_NEAR(cost_of(way + 1.9, 3), cost_of(7.5, 3), 1e-6) << "stops in 0.7 m";
}

TEST(SingleTrackModel, PredictsFromTheYawRateAndTheSlipOfTheStart) {
  Lane lane(5.0, 2, 3);
  VehicleModel& model = lane.standing_at(5);
  model.set_start({{10, 0, 0.1}, 5, 0.05, 0.8, -0.06}, 5);
  std::vector<PredictedState> states(horizon + 1);
  model.predict(inputs_of(0, 0), states);
  EXPECT_NEAR(states[0].yaw_rate, 0.8, 1e-9);
  EXPECT_NEAR(states[0].slip, -0.06, 1e-6);
  EXPECT_NEAR(states[0].speed, 5, 1e-9);
  EXPECT_NEAR(states[0].steer, 0.05, 1e-9);
  EXPECT_NEAR(states[0].pose.yaw, 0.1, 1e-9);
}

}  // namespace
}  // namespace slalom::vehicle::detail::ways_around_test
