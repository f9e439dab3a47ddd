// A drive equals a lap without interventions; the same interventions give the same result; a copy goes on
// alike.
// Estimated poses: of the planner (world.localised), which gets the IMU, too, while servo and motor stay; and
// of the tracker (world.tracking=localised).
// The cost of a sequence does not depend on its time step and length.
#include <gtest/gtest.h>

#include <numeric>

#include "evaluation/courses.hpp"
#include "slalom/evaluation/lap.hpp"
#include "slalom/evaluation/sequence_cost.hpp"

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

LapResult lap(const char* name, const LapSettings& settings, const char* place = "fox", double timeout = 0) {
  const auto whole = course(place);
  const auto environment = timeout > 0 ? timed_out_after(timeout, whole) : whole;
  return run_lap({environment, {configuration(name)}, settings}, 3);
}

TEST(LocalisedLap, ThePlannerGetsAnEstimateOfThePose) {
  const LapResult with = lap("default", {.localised = true}, "wren"), without = lap("default", {}, "wren");
  EXPECT_TRUE(with.finished);
  EXPECT_EQ(with.collisions, 0);
  EXPECT_TRUE(without.localisation.error.empty());
  ASSERT_EQ(with.localisation.error.size(), static_cast<std::size_t>(with.steps));
  EXPECT_GT(*std::min_element(with.localisation.error.begin(), with.localisation.error.end()), 0);
  // The servo and the motor are those of the simulated car, so the lap takes as long.
  EXPECT_NEAR(with.time, without.time, 0.02 * without.time);
}

TEST(LocalisedLap, TheEstimateHoldsNearTheLimitOfGrip) {
  const LapResult racing = lap("race", {.saturating_tyres = true, .localised = true});
  EXPECT_TRUE(racing.finished);
  EXPECT_EQ(racing.collisions, 0);
  const auto& errors = racing.localisation.error;
  EXPECT_LT(std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size()), 0.12);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.6F);
}

TEST(LocalisedLap, ParkedCarsThatHideWallsDoNotMoveTheEstimateElsewhere) {
  // On wren, views of two parked cars and what they leave of the walls look like those of places metres away.
  auto driver = configuration("hardware", 0);
  driver.planner.latency = 0.01;
  const LapSettings settings{.obstacles = 5, .hardware = HardwareConditions{}, .latency = 0.01};
  for (const auto& [method, seed] : {std::pair("mppi", 310), std::pair("svg_mppi", 290)}) {
    const LapResult result = run_lap({timed_out_after(8), {driver, method}, settings}, seed);
    const auto& errors = result.localisation.error;
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.5F) << method;
    EXPECT_EQ(result.localisation.blind, 0) << method;
  }
}

TEST(LocalisedLap, ItsSensorsAreThoseOfTheWorld) {
  const LapResult usual = lap("default", {.localised = true}, "wren", 1);
  const LapResult noisy = lap("default", {.range_noise = 0.05, .localised = true}, "wren", 1);
  EXPECT_NE(noisy.localisation.error, usual.localisation.error);
  const HardwareConditions real;
  LapSettings both{.hardware = real, .localised = true};
  EXPECT_EQ(lap("default", both, "wren", 1).mean_speed,
            lap("default", {.hardware = real}, "wren", 1).mean_speed);
}

TEST(TrackedLap, AnEstimatedPoseIsAsGoodAsTheTrueOne) {
  auto driver = configuration("default_kinematic", 0);
  driver.planner.predict_others = false;  // so that both laps are the same
  LapSettings settings{.opponents = 4, .range_noise = 0.02, .dropout = 0.02, .tracking = TrackingMode::exact};
  settings.opponent_speed = 0.6;
  const auto wren = course("wren");
  // In this lap the car hits another one.
  const TrackingRecord exact = run_lap({wren, {driver}, settings}, 110).tracking;
  settings.tracking = TrackingMode::localised;
  const TrackingRecord localised = run_lap({wren, {driver}, settings}, 110).tracking;
  EXPECT_GT(localised.in_view, 300);
  EXPECT_EQ(localised.in_view, exact.in_view);
  EXPECT_GT(localised.long_detected, 0.97 * exact.long_detected);
  EXPECT_LE(localised.false_objects, exact.false_objects + 1);
  // The lap depends on the instruction set: after some collisions even the true pose leaves larger errors.
  EXPECT_LT(localised.position_error, std::max(0.1, exact.position_error + 0.02));
}

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
