// What is sent where the solution is not the best sequence known.
#include "vehicle/planner/sequence_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/reference_field.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr int horizon = 20;
constexpr double time_step = 0.05;  // s

std::vector<maps::ReferencePoint> straight() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 600; ++i) path.push_back({0.1 * i, 0, 0, 5});
  return path;
}

VehicleOptions car() {
  VehicleOptions options;
  options.model = vehicle_model("single_track");
  options.hold_first_input = false;
  options.max_acceleration = options.max_deceleration = 9;
  return options;
}

/// A car at 4 m/s on a straight course without obstacles.
class SequenceChoiceTest : public ::testing::Test {
 protected:
  SequenceChoiceTest()
      : field_(straight()),
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

TEST_F(SequenceChoiceTest, GoesOnAsPlannedWhereTheSolutionIsWorse) {
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

TEST_F(SequenceChoiceTest, TakesTheSolutionWhereItIsBetter) {
  const auto sent = sequence(0.4f), solution = sequence(0);
  choice_.sent(sent);
  EXPECT_EQ(kept_or(solution, 0.04).inputs.data(), solution.data());
}

}  // namespace
}  // namespace slalom::vehicle::detail
