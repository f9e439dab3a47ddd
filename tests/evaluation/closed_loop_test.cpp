// A closed loop equals a lap of LapRunner without interventions; the same interventions give the same result.
#include "slalom/evaluation/closed_loop.hpp"

#include <gtest/gtest.h>

#include "slalom/vehicle/configuration/configuration.hpp"

namespace slalom::evaluation {
namespace {

std::shared_ptr<const LapRunner> runner(const std::string& method,
                                        const LapSettings& settings = {.obstacles = 2}) {
  static const auto environment = load_environment(SLALOM_COURSES "/stag", Protocol::true_physics, {});
  vehicle::Configuration configuration;
  for (const char* each : {"svg_mppi", "mppi"}) {
    vehicle::set_option(configuration, "samples", "256", each);
    vehicle::set_option(configuration, "horizon", "14", each);
    vehicle::set_option(configuration, "variance", "0.05", each);
    vehicle::set_option(configuration, "input_min", "-0.4", each);
    vehicle::set_option(configuration, "input_max", "0.4", each);
  }
  return std::make_shared<const LapRunner>(environment, configuration, method, settings);
}

TEST(ClosedLoop, FirstLapEqualsTheLapOfTheRunner) {
  auto alone = *runner("mppi");
  std::vector<double> steering, times;
  alone.run(3, [&](const ControlStep& tick) {
    steering.push_back(tick.output.command.steer);
    times.push_back(tick.time);
  });
  ClosedLoop loop(runner("mppi"), 3);
  ASSERT_GT(steering.size(), 100u);
  for (std::size_t i = 0; i < steering.size(); ++i) {
    loop.step([&](const ControlStep& tick) {
      ASSERT_EQ(tick.output.command.steer, steering[i]) << i;
      ASSERT_EQ(tick.time, times[i]) << i;
    });
  }
  EXPECT_GE(loop.world().laps(0)->laps(), 1);
  const double there = loop.world().state(0).x;
  for (int i = 0; i < 20; ++i) loop.step();
  EXPECT_NE(loop.world().state(0).x, there) << "the car drives on";
}

/// A loop with an obstacle, another method and a late command on the way.
sim::CarState with_interventions() {
  ClosedLoop loop(runner("mppi"), 5);
  for (int i = 0; i < 60; ++i) {
    if (i == 20) loop.world().add_disc({{loop.world().state(0).x + 1, loop.world().state(0).y}, 0.1});
    if (i == 40) loop.change_controller(runner("svg_mppi"));
    loop.step({}, i == 30 ? 0.02 : 0);
  }
  EXPECT_EQ(loop.steps(), 60);
  return loop.world().state(0);
}

TEST(ClosedLoop, SameInterventionsGiveTheSameDrive) {
  const sim::CarState once = with_interventions();
  EXPECT_TRUE(once == with_interventions());
  ClosedLoop untouched(runner("mppi"), 5);
  for (int i = 0; i < 60; ++i) untouched.step();
  EXPECT_FALSE(once == untouched.world().state(0));
}

TEST(ClosedLoop, AnOpponentKeepsItsPlannerWhenTheControllerOfTheCarChanges) {
  // Half the course ahead, where neither car sees the other.
  const LapSettings settings{.opponents = 1, .planning_opponents = 1};
  const auto drive = [&](const char* later) {
    ClosedLoop loop(runner("mppi", settings), 5);
    for (int i = 0; i < 60; ++i) {
      if (i == 20) loop.change_controller(runner(later, settings));
      loop.step();
    }
    return std::pair(loop.world().state(0), loop.world().state(1));
  };
  const auto [car, opponent] = drive("mppi");
  const auto [other_car, same_opponent] = drive("svg_mppi");
  EXPECT_FALSE(car == other_car);
  EXPECT_TRUE(opponent == same_opponent);
  EXPECT_GT(opponent.speed, 0.5);
}

TEST(ClosedLoop, RejectsAnotherEnvironmentOrPeriod) {
  ClosedLoop loop(runner("mppi"), 1);
  vehicle::Configuration slower = runner("mppi")->configuration();
  slower.planner.control_period = 0.05;
  const auto environment = load_environment(SLALOM_COURSES "/stag", Protocol::true_physics, {});
  EXPECT_THROW(
      loop.change_controller(std::make_shared<const LapRunner>(environment, slower, "mppi", LapSettings{})),
      std::invalid_argument);
}

TEST(ClosedLoop, PredictionFollowsThePlan) {
  ClosedLoop loop(runner("svg_mppi"), 2);
  int compared = 0;
  for (int i = 0; i < 30; ++i) {
    loop.step([&](const ControlStep& tick) {
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
