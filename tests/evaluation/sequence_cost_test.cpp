// The cost of a sequence does not depend on its time step and length.
#include "slalom/evaluation/sequence_cost.hpp"

#include <gtest/gtest.h>

namespace slalom::evaluation {
namespace {

constexpr double speed = 2, offset = 0.33;  // m/s, m beside the path

std::vector<maps::ReferencePoint> straight_path() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 300; ++i) path.push_back({0.1 * i - 5, 0, 0, speed});
  return path;
}

/// A car that drives straight on beside the path, as a planner with this step and horizon predicts it.
struct Straight {
  std::vector<vehicle::PredictedState> states;
  std::vector<float> inputs;
  vehicle::PlannerOutput output;
  vehicle::VehicleOptions model;

  Straight(double time_step, int horizon) : inputs(static_cast<std::size_t>(horizon)) {
    model.time_step = time_step;
    for (int k = 0; k <= horizon; ++k) {
      const double x = 0.012 + k * time_step * speed;
      states.push_back({{x, offset, 0}, speed, 0, {x - 0.012, 0, 0}});
    }
    output.inputs = inputs;
    output.predicted = states;
  }
};

const std::vector<float> nothing_near(1080, 30.0f);

SequenceCostMeter::Cost cost(const Straight& straight) {
  SequenceCostMeter meter(straight_path(), straight.model);
  meter.observe({.ranges = nothing_near, .angle_min = -2.35, .angle_increment = 4.7 / 1079, .range_max = 30},
                {0.012, offset, 0});
  return meter.planned(straight.output);
}

TEST(SequenceCost, EqualsTheDistanceOfAStraightLine) {
  const auto c = cost(Straight(0.05, 14));
  // Cells of 0.1 m: each look-up is at most 0.05 m off in each axis.
  EXPECT_NEAR(c.state, 15 * offset * offset, 15 * (2 * offset * 0.06 + 0.0036));
  EXPECT_EQ(c.collision, 0);
}

TEST(SequenceCost, IsTheSameWhateverStepAndHorizon) {
  const double usual = cost(Straight(0.05, 14)).total();
  EXPECT_NEAR(cost(Straight(0.05, 30)).total(), usual, 1e-9) << "cut at 15 states";
  EXPECT_NEAR(cost(Straight(0.025, 28)).total(), usual, 1e-9) << "every other state";
  EXPECT_NEAR(cost(Straight(0.02, 40)).total(), usual, 1e-9) << "interpolated";
  EXPECT_NEAR(cost(Straight(0.05, 6)).total(), usual, 0.01) << "its last input is held";
  EXPECT_NEAR(cost(Straight(0.1, 3)).total(), usual, 0.01) << "both";
}

TEST(SequenceCost, WithoutASequenceEqualsTheCostOfThePresentState) {
  Straight none(0.05, 14);
  none.output.predicted = {};
  none.output.inputs = {};
  EXPECT_NEAR(cost(none).state, 15 * offset * offset, 15 * (2 * offset * 0.06 + 0.0036));
}

TEST(SequenceCost, CollidesWhereThePublishedMapSays) {
  Straight ahead(0.05, 14);
  SequenceCostMeter meter(straight_path(), ahead.model);
  std::vector<float> ranges(1080, 30.0f);
  for (std::size_t i = 520; i < 560; ++i) ranges[i] = 0.9f;
  meter.observe({.ranges = ranges, .angle_min = -2.35, .angle_increment = 4.7 / 1079, .range_max = 30},
                {0.012, offset, 0});
  const auto c = meter.planned(ahead.output);
  // Points 1.175 m ahead forbid the rear axle about 0.7 to 1.3 m ahead; a state stands every 0.1 m.
  EXPECT_GE(c.collision, 500);
  EXPECT_LE(c.collision, 800);
  EXPECT_EQ(meter.present().collision, 0);
}

}  // namespace
}  // namespace slalom::evaluation
