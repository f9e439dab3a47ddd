// The choice of the sequence that is sent, where the solution is not the best one known.
#include "vehicle/planner/sequence_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/maps/reference_field.hpp"
#include "support/lane.hpp"
#include "support/predicted.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr int horizon = 20;
constexpr double time_step = 0.05;  // s

VehicleOptions car() {
  VehicleOptions options;
  options.model = vehicle_model("single_track");
  options.hold_first_input = false;
  options.max_acceleration = options.max_deceleration = 9;
  return options;
}

/// A car at 4 m/s on a straight course without obstacles.
class SequenceSelection : public ::testing::Test {
 protected:
  SequenceSelection()
      : field_(testing::lane(5)),
        model_(make_vehicle_model(car())),
        choice_(horizon, 2, model_->traits()),
        states_(horizon + 1) {
    clearance_.add(std::vector<maps::Point>{});
    field_.update({10, 0});
    model_->set_maps({field_.view(), clearance_.view(), {10, 0, 0}});
    model_->set_start({{10, 0, 0}, 4}, 5);
  }

  /// Steering (rad) in every step, and accelerations (m/s^2) that rise by 0.1 from step to step.
  static std::vector<float> sequence(float steer) {
    std::vector<float> inputs;
    for (int k = 0; k < horizon; ++k) {
      inputs.push_back(steer);
      inputs.push_back(1 + 0.1f * static_cast<float>(k));
    }
    return inputs;
  }
  SequenceChoice::Choice kept_or(const std::vector<float>& solution, double elapsed) {
    const PredictedCost cost = model_->predict(solution, states_);
    return choice_.kept(*model_, {solution, cost}, elapsed, states_);
  }

  maps::ReferenceField field_;
  maps::ClearanceMap clearance_;
  std::unique_ptr<VehicleModel> model_;
  SequenceChoice choice_;
  std::vector<PredictedState> states_;
};

TEST_F(SequenceSelection, KeepsThePlanWhereTheSolutionIsWorse) {
  const auto sent = sequence(0), solution = sequence(0.4f);
  EXPECT_EQ(kept_or(solution, 0.04).inputs.data(), solution.data()) << "nothing was sent before";
  choice_.sent(sent);
  const auto chosen = kept_or(solution, 1.2 * time_step);
  ASSERT_EQ(chosen.inputs.size(), sent.size());
  for (int k = 0; k < horizon; ++k) {
    const auto row = static_cast<std::size_t>(2 * k);
    EXPECT_EQ(chosen.inputs[row], 0);
    // 1.2 steps later, with the last input held.
    EXPECT_NEAR(chosen.inputs[row + 1], std::min(1 + 0.1 * (k + 1.2), 1 + 0.1 * (horizon - 1)), 1e-6) << k;
  }
  std::vector<PredictedState> states(horizon + 1);
  EXPECT_EQ(model_->predict(chosen.inputs, states).state, chosen.cost.state);
  EXPECT_EQ(states.back().pose.x, states_.back().pose.x) << "the prediction is that of the choice";
  choice_.reset();
  EXPECT_EQ(kept_or(solution, 0.04).inputs.data(), solution.data()) << "forgotten";
}

TEST_F(SequenceSelection, TakesTheSolutionWhereItIsBetter) {
  const auto sent = sequence(0.4f), solution = sequence(0);
  choice_.sent(sent);
  EXPECT_EQ(kept_or(solution, 0.04).inputs.data(), solution.data());
}

/// A car at 6 m/s in whose way there may be walls.
class PlanNearAWall : public ::testing::Test {
 protected:
  explicit PlanNearAWall(Objective objective = Objective::lap_time) : field_(testing::lane(5)) {
    VehicleOptions options = car();
    options.body.margin = 0.05;
    options.own_of<SingleTrackOptions>().objective = objective;
    model_ = make_vehicle_model(options);
    choice_ = std::make_unique<SequenceChoice>(horizon, 2, model_->traits());
    field_.update({10, 0});
  }

  /// A wall from one point to another, m in the frame of the car.
  void see_wall(maps::Point from, maps::Point to, const maps::MovingObstaclesView& others = {}) {
    std::vector<maps::Point> points;
    for (int i = 0; i <= 200; ++i)
      points.push_back({from.x + (to.x - from.x) * i / 200, from.y + (to.y - from.y) * i / 200});
    clearance_.add(points);
    model_->set_maps({field_.view(), clearance_.view(), {10, 0, 0}, others});
    model_->set_start({{10, 0, 0}, 6}, 5);
    choice_->sees(clearance_.view(), others);
  }
  static std::vector<float> held(float steer, float acceleration) {
    std::vector<float> inputs;
    for (int k = 0; k < horizon; ++k) inputs.insert(inputs.end(), {steer, acceleration});
    return inputs;
  }
  SequenceChoice::Choice chosen_for(const std::vector<float>& solution) {
    states_.resize(horizon + 1);
    const PredictedCost cost = choice_->predict(*model_, solution, states_);
    EXPECT_TRUE(cost.collided);
    choice_->sent(solution);
    const auto best = choice_->kept(*model_, {solution, cost}, 0, states_);
    const auto cheapest = choice_->cheapest(*model_, {}, best, states_);
    return cheapest.cost.collided ? choice_->stop(*model_, {}, cheapest, false, states_) : cheapest;
  }

  maps::ReferenceField field_;
  maps::ClearanceMap clearance_{{.length_x = 14, .center_x = 5}};
  std::unique_ptr<VehicleModel> model_;
  std::unique_ptr<SequenceChoice> choice_;
  std::vector<PredictedState> states_;
};

struct PathSpeeds : PlanNearAWall {
  PathSpeeds() : PlanNearAWall(Objective::path_speed) {}
};

// The body's discs have a radius of 0.18 m; the wall is 0.02 to 0.04 m from them, and the margin 0.05 m.
TEST_F(PlanNearAWall, PaysForTheMarginOfTheBody) {
  see_wall({2, 0.2}, {6, 0.2});
  std::vector<PredictedState> states(horizon + 1);
  const auto straight_on = held(0, 0);
  EXPECT_TRUE(model_->predict(straight_on, states).collided);
  const PredictedCost cost = choice_->predict(*model_, straight_on, states);
  EXPECT_FALSE(cost.collided);
  EXPECT_GE(cost.collision, 100) << "the cost of a collision remains";
}

/// Another car as it stands on the way, 3 m ahead and `offset` m to the left.
struct Standing : testing::Predicted {
  explicit Standing(double offset)
      : Predicted(0.58, 0.31, {{1, {13, offset, 0}, 0, 0.02, 0.02}}, 3),
        obstacles(maps::MovingObstacleOptions{}, horizon) {
    obstacles.update({&obstacle, 1}, {10, 0}, 0, time_step);
  }
  maps::MovingObstacles obstacles;
};

TEST_F(PlanNearAWall, PaysForTheMarginOfTheBodyAmongOthersToo) {
  const auto collides_among = [&](double offset) {
    const Standing other(offset);
    see_wall({2, 0.2}, {6, 0.2}, other.obstacles.view());
    std::vector<PredictedState> states(horizon + 1);
    EXPECT_TRUE(model_->predict(held(0, 0), states).collided);
    return choice_->predict(*model_, held(0, 0), states).collided;
  };
  EXPECT_FALSE(collides_among(-0.5));
  EXPECT_TRUE(collides_among(-0.1)) << "what moves is not in the clearances";
}

TEST_F(PlanNearAWall, CollidesWithTheBodyItself) {
  see_wall({4, -2}, {4, 2});
  std::vector<PredictedState> states(horizon + 1);
  EXPECT_TRUE(choice_->predict(*model_, held(0, 0), states).collided);
}

TEST_F(PathSpeeds, ACarThatFollowsThemKeepsTheMargin) {
  see_wall({2, 0.2}, {6, 0.2});
  std::vector<PredictedState> states(horizon + 1);
  EXPECT_TRUE(choice_->predict(*model_, held(0, 0), states).collided);
}

TEST_F(PlanNearAWall, BrakesBeforeAWallAcrossTheWay) {
  see_wall({2.8, -3}, {2.8, 3});
  const auto solution = held(0.2f, 0);
  const auto chosen = chosen_for(solution);
  EXPECT_LT(chosen.inputs[1], -5);
  std::vector<PredictedState> states(horizon + 1);
  choice_->predict(*model_, solution, states);
  EXPECT_LT(states_.back().speed, 0.5 * states.back().speed);
}

// The car is about to touch the wall beside it. Brakes would turn it into the wall, and would take next to
// nothing from its speed.
TEST_F(PlanNearAWall, ContinuesWhereBrakingComesTooLate) {
  see_wall({0.9, 0.12}, {2, 0.12});
  const auto chosen = chosen_for(held(0, 1));
  for (std::size_t k = 0; k < horizon; ++k) EXPECT_EQ(chosen.inputs[2 * k + 1], 1) << k;
}

}  // namespace
}  // namespace slalom::vehicle::detail
