// A drive equals a lap without interventions; the same interventions give the same result; a copy goes on
// alike.
#include "slalom/evaluation/lap.hpp"

#include <gtest/gtest.h>

#include "evaluation/courses.hpp"

namespace slalom::evaluation {
namespace {

LapSetup lap(const std::string& method, const LapSettings& settings = {.obstacles = 2}) {
  static const auto environment = course("stag");
  return {environment, {quick_configuration(), method}, settings};
}

TEST(LapDrive, AnOpponentKeepsItsPlannerWhenTheControllerOfTheCarChanges) {
  // Half the course ahead, where neither car sees the other.
  const LapSettings settings{.opponents = 1, .planning_opponents = 1};
  const auto states = [&](const char* later) {
    LapDrive drive(lap("mppi", settings), 5);
    for (int i = 0; i < 60; ++i) {
      if (i == 20) drive.change_driver(lap(later).driver);
      drive.step();
    }
    return std::pair(drive.world().state(0), drive.world().state(1));
  };
  const auto [car, opponent] = states("mppi");
  const auto [other_car, same_opponent] = states("svg_mppi");
  EXPECT_FALSE(car == other_car);
  EXPECT_TRUE(opponent == same_opponent);
  EXPECT_GT(opponent.speed, 0.5);
}

TEST(LapDrive, ACopyGoesOnWithTheSameBits) {
  // Drivers with a planner and without, and sensors with localiser and tracker.
  const LapSettings among_all{.obstacles = 1,
                              .opponents = 3,
                              .opponent_driver = sim::OpponentDriver::erratic,
                              .planning_opponents = 1,
                              .opponent_gap = 3,
                              .localised = true,
                              .tracking = TrackingMode::localised};
  const auto figures = [](const LapDrive& drive) {
    std::vector<double> all;
    for (std::size_t car = 0; car < drive.world().cars(); ++car) {
      const sim::CarState& state = drive.world().state(car);
      all.insert(all.end(), {state.x, state.y, state.yaw, state.speed, state.steer});
    }
    return all;
  };
  LapSetup setup = lap("svg_mppi", among_all);
  setup.environment = timed_out_after(0.8);
  LapDrive drive(setup, 7);
  for (int i = 0; i < 16; ++i) drive.step();
  LapDrive copy = drive, assigned(lap("mppi"), 1);
  assigned = copy;
  const LapResult whole = drive.finish();
  for (LapDrive* other : {&copy, &assigned}) {
    const LapResult same = other->finish();
    EXPECT_EQ(figures(*other), figures(drive));
    EXPECT_EQ(same.time, whole.time);
    EXPECT_EQ(same.steps, whole.steps);
    EXPECT_EQ(same.mean_sequence_cost(), whole.mean_sequence_cost());
    EXPECT_EQ(same.localisation.error, whole.localisation.error);
    EXPECT_EQ(same.tracking.position_error, whole.tracking.position_error);
    EXPECT_EQ(same.overtaking.encounters.size(), whole.overtaking.encounters.size());
  }
}

TEST(LapDrive, RejectsAnotherControlPeriod) {
  LapDrive drive(lap("mppi"), 1);
  Driver slower = lap("mppi").driver;
  slower.configuration.planner.control_period = 0.05;
  EXPECT_THROW(drive.change_driver(slower), std::invalid_argument);
}

TEST(LapDrive, PredictionFollowsThePlan) {
  LapDrive drive(lap("svg_mppi"), 2);
  int compared = 0;
  for (int i = 0; i < 30; ++i) {
    drive.step([&](const ControlStep& tick) {
      if (!tick.output.solve) return;
      std::vector<vehicle::PredictedState> states(tick.output.inputs.size() + 1);
      const auto cost = tick.planner.predict(tick.output.inputs, states);
      EXPECT_EQ(cost.state, tick.output.state_cost);
      EXPECT_EQ(cost.collision, tick.output.collision_cost);
      EXPECT_LE(cost.distance, cost.state);
      EXPECT_EQ(states.back().pose.x, tick.output.predicted.back().pose.x);
      ++compared;
    });
  }
  EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace slalom::evaluation
