// Laps under the conditions of their settings; DriveCommand tests that they finish and repeat bit for bit.
#include "slalom/evaluation/lap.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "evaluation/courses.hpp"
#include "support/thrown_words.hpp"

namespace slalom::evaluation {
namespace {

/// Everything of a lap that may not depend on the clock of the wall.
std::vector<std::uint64_t> bits(const LapResult& lap) {
  std::vector<std::uint64_t> all = {lap.seed, static_cast<std::uint64_t>(lap.steps),
                                    static_cast<std::uint64_t>(lap.collisions), lap.finished};
  for (const double value : {lap.time, lap.state_cost, lap.collision_cost, lap.input_error, lap.mean_speed,
                             lap.mean_path_distance, lap.min_clearance, lap.mean_variance})
    all.push_back(std::bit_cast<std::uint64_t>(value));
  return all;
}

/// As files in UTM coordinates give it.
std::shared_ptr<const Environment> at_utm_coordinates(vehicle::Course course, Protocol protocol) {
  const auto shift = [](auto& point) {
    point.x += 500000;
    point.y += 5000000;
  };
  maps::Pose start = course.start;
  shift(start);
  shift(course.map.origin);
  for (auto& point : course.waypoints) shift(point);
  for (auto& point : course.obstacle_path) shift(point);
  vehicle::complete_course(course, course.closed);
  course.start = start;
  vehicle::move_to_local_origin(course);
  return make_environment(std::move(course), protocol);
}

TEST(Lap, DrivesTheSameLapAtUtmCoordinates) {
  for (const Protocol protocol : {Protocol::true_physics, Protocol::published}) {
    SCOPED_TRACE(name(protocol));
    const auto here = course("eel", protocol);
    const auto there = at_utm_coordinates(here->course, protocol);
    EXPECT_EQ(here->course.origin.x, 0);
    EXPECT_EQ(there->course.origin.x, 500000);
    EXPECT_EQ(there->course.origin.y, 5000000);
    LapSettings settings{.obstacles = 2};
    const LapResult a = run_lap({timed_out_after(2, here), {configuration("default")}, settings}, 0);
    const LapResult b = run_lap({timed_out_after(2, there), {configuration("default")}, settings}, 0);
    EXPECT_EQ(bits(a), bits(b));
  }
}

TEST(Lap, StartsWhereTheCarHasRoom) {
  vehicle::Course course = evaluation::course("wren")->course;
  const vehicle::Waypoint& first = course.waypoints.front();
  course.start = {first.x, first.y, first.yaw};
  const double side = 0.12;  // m to the left of the first waypoint, less than half the car's width
  const maps::Point cell = maps::inverse_transform(
      course.map.origin, {first.x - side * std::sin(first.yaw), first.y + side * std::cos(first.yaw)});
  course.map.at(static_cast<int>(cell.x / course.map.resolution),
                static_cast<int>(cell.y / course.map.resolution)) = maps::Occupancy::occupied;
  const auto moved = make_environment(course, Protocol::true_physics);
  EXPECT_GT(moved->start_moved, 0.29) << "at least half the car's length";
  EXPECT_LT(moved->start_moved, 1);
  EXPECT_NEAR(std::hypot(moved->start.x - first.x, moved->start.y - first.y), moved->start_moved, 0.05);
  moved->timeout = 0.1;
  EXPECT_EQ(run_lap({moved, {configuration("default")}, {}}, 0).collisions, 0);

  course.start.yaw += 1e-6;  // given by course.yaml
  const auto given = make_environment(course, Protocol::true_physics);
  EXPECT_EQ(given->start_moved, 0);
  EXPECT_THROW(run_lap({given, {configuration("default")}, {}}, 0), std::invalid_argument);
}

TEST(Lap, DrivesWithTheAccelerationAsAnInputByEveryMethod) {
  const double usual = run_lap({course("wren"), {configuration("default_kinematic")}, {}}, 0).time;
  const auto begun = timed_out_after(3);
  for (const char* name : {"default", "default_speed"}) {
    for (const char* method : {"mppi", "svg_mppi", "reverse_mppi", "sv_mpc", "cem"}) {
      SCOPED_TRACE(std::string(name) + ", " + method);
      const bool whole = method == std::string("svg_mppi");
      const LapResult lap = run_lap({whole ? course("wren") : begun, {configuration(name), method}, {}}, 0);
      EXPECT_TRUE(std::isfinite(lap.mean_sequence_cost()));
      EXPECT_GT(lap.mean_speed, 0.3);
      if (!whole) continue;
      EXPECT_TRUE(lap.finished);
      EXPECT_EQ(lap.collisions, 0);
      EXPECT_LT(lap.time, 1.3 * usual);
    }
  }
}

TEST(Lap, CostEqualsThePlannersInThePublishedConfiguration) {
  const LapSetup setup{course("wren", Protocol::published), {configuration("published")}, {.obstacles = 2}};
  int ticks = 0;
  const LapResult lap = run_lap(setup, 0, [&](const ControlStep& tick) {
    ++ticks;
    ASSERT_EQ(tick.cost.state, tick.output.state_cost) << tick.step;
    ASSERT_EQ(tick.cost.collision, tick.output.collision_cost) << tick.step;
  });
  EXPECT_EQ(ticks, lap.steps);
  EXPECT_GT(ticks, 100);
}

TEST(Lap, APlannerThatEstimatesTheCarKnowsThePeriodOfThePublishedEvaluation) {
  const LapSetup setup{course("wren", Protocol::published), {configuration("default")}, {}};
  double gain = 0, speed_error = 0;
  const LapResult lap = run_lap(setup, 0, [&](const ControlStep& tick) {
    gain = tick.output.parameters.steering_gain;
    speed_error = std::max(speed_error, std::abs(tick.output.speed_estimate - tick.seen.speed));
  });
  EXPECT_TRUE(lap.finished);
  EXPECT_NEAR(gain, 1, 0.05) << "0.85 with a period of 0.025 s";
  EXPECT_LT(speed_error, 0.1);
}

TEST(Lap, LatencyDelaysCommands) {
  const auto environment = course("wren");
  const auto first_motion = [&](double latency) {
    double start = -1;
    run_lap({environment, {configuration("default_kinematic", 64), "mppi"}, {.latency = latency}}, 0,
            [&](const ControlStep& tick) {
              if (start < 0 && tick.seen.speed > 0) start = tick.time;
            });
    return start;
  };
  EXPECT_NEAR(first_motion(0.1) - first_motion(0), 0.1, 1e-6);
}

// Commands have an effect 80 ms later than the planner is told. It learns that when the car starts.
TEST(Lap, SpeedsAreThosePlannedThoughCommandsAreLate) {
  const LapSettings settings{.obstacles = 5, .latency = 0.1, .friction = 0.7, .saturating_tyres = true};
  std::vector<std::pair<double, double>> planned;  // s, m/s
  double error = 0;                                // m/s
  std::size_t at = 0;
  run_lap({timed_out_after(6, course("eel")), {configuration("default")}, settings}, 3,
          [&](const ControlStep& tick) {
            if (tick.time > 1 && tick.output.predicted.size() > 6)
              planned.emplace_back(tick.time + 0.1 + 6 * 0.05, tick.output.predicted[6].speed);
            for (; at < planned.size() && planned[at].first <= tick.time; ++at)
              error += std::abs(tick.seen.speed - planned[at].second);
          });
  EXPECT_LT(error, 0.25 * static_cast<double>(at));
}

TEST(Lap, HardwareLapsApplyTheirConditions) {
  const auto environment = timed_out_after(2);
  const auto lap = [&](const HardwareConditions& conditions, std::uint64_t seed) {
    const LapSettings settings{.hardware = conditions};
    return run_lap({environment, {configuration("default", 128)}, settings}, seed);
  };
  const LapResult first = lap({}, 3), other = lap({}, 4);
  EXPECT_EQ(first.collisions, 0);
  EXPECT_GT(first.mean_speed, 0.5);
  EXPECT_NE(first.localisation.error, other.localisation.error);
  EXPECT_EQ(first.localisation.error.size() + static_cast<std::size_t>(first.localisation.blind),
            static_cast<std::size_t>(first.steps));

  HardwareConditions bent, late;
  bent.steering_offset = 0.05;
  late.steering_dead_time = 0.1;
  EXPECT_NE(bits(lap(bent, 3)), bits(first));
  EXPECT_NE(bits(lap(late, 3)), bits(first));
}

TEST(Lap, ATrackerFindsTheOtherCars) {
  auto driver = configuration("default_kinematic", 64);
  const auto lap = [&, environment = timed_out_after(5)](TrackingMode mode, int opponents, bool predicts) {
    driver.planner.predict_others = predicts;
    const LapSettings settings{
        .opponents = opponents, .opponent_gap = 3, .range_noise = 0.02, .dropout = 0.02, .tracking = mode};
    return run_lap({environment, {driver, "mppi"}, settings}, 2);
  };
  const LapResult without = lap(TrackingMode::off, 2, true), alone = lap(TrackingMode::off, 0, true);
  for (const TrackingMode mode : {TrackingMode::exact, TrackingMode::localised}) {
    const LapResult with = lap(mode, 2, false), empty = lap(mode, 0, true), predicts = lap(mode, 2, true);
    EXPECT_EQ(bits(with), bits(without)) << "the planner does not use the tracker";
    EXPECT_EQ(bits(empty), bits(alone)) << "nobody is there";
    EXPECT_NE(bits(predicts), bits(without));
    EXPECT_EQ(with.tracking.false_objects + empty.tracking.false_objects, 0);
    EXPECT_GT(with.tracking.in_view, 20);
    EXPECT_GE(with.tracking.long_detected, 0.95 * with.tracking.long_in_view);
    EXPECT_LT(with.tracking.position_error, 0.15);
  }
}

TEST(Lap, ACarThatCannotLocaliseStops) {
  const auto environment = timed_out_after(2);
  HardwareConditions blind{.dropout = 1};
  const LapResult lap =
      run_lap({environment, {configuration("default_kinematic", 64), "mppi"}, {.hardware = blind}}, 1);
  EXPECT_FALSE(lap.finished);
  EXPECT_GT(lap.localisation.blind, lap.steps / 2);
  EXPECT_LT(lap.mean_speed, 0.5);
  EXPECT_EQ(lap.collisions, 0);
}

TEST(Lap, TheWorldCanBeMadeHarder) {
  const auto whole = course("wren"), begun = timed_out_after(3);
  const auto lap = [&](const char* key, const char* value, const auto& environment) {
    LapSettings settings;
    if (key) {
      EXPECT_TRUE(set_world_option(settings, key, value)) << key;
    }
    return run_lap({environment, {configuration("default_kinematic", 64), "mppi"}, settings}, 0);
  };
  const LapResult usual = lap(nullptr, nullptr, whole), usual_begin = lap(nullptr, nullptr, begun);
  for (const auto& [key, value] :
       std::vector<std::pair<const char*, const char*>>{{"world.friction", "0.6"},
                                                        {"world.saturating_tyres", "true"},
                                                        {"world.steering_gain", "0.9"},
                                                        {"world.range_noise", "0.05"},
                                                        {"world.dropout", "0.2"},
                                                        {"world.latency", "0.05"}})
    EXPECT_NE(bits(lap(key, value, begun)), bits(usual_begin)) << key;
  const LapResult fast = lap("world.speed_scale", "1.2", whole),
                  slow = lap("world.speed_scale", "0.8", whole);
  EXPECT_NEAR(slow.mean_speed / usual.mean_speed, 0.8, 0.03);
  EXPECT_NEAR(fast.mean_speed / usual.mean_speed, 1.2, 0.05);
  LapSettings settings;
  EXPECT_FALSE(set_world_option(settings, "vehicle.friction", "1"));
  EXPECT_THROW(set_world_option(settings, "world.fricton", "1"), std::invalid_argument);
  EXPECT_THROW(set_world_option(settings, "world.friction", "-1"), std::invalid_argument);
  const LapSetup published{
      course("wren", Protocol::published), {configuration("default"), "mppi"}, {.friction = 0.7}};
  EXPECT_THROW(published.validate(), std::invalid_argument);
}

TEST(Lap, RejectsInvalidSettings) {
  const auto environment = course("wren");
  const auto refuses = [](const LapSetup& setup, const char* word) {
    expect_error_with<std::invalid_argument>({word}, [&] { setup.validate(); });
  };
  const Driver usual{configuration("default"), "mppi"};
  refuses({environment, {usual.configuration, "guess"}}, "guess");
  refuses({environment, usual, {.obstacles = -1}}, "obstacles");
  refuses({environment, usual, {.start = maps::Pose{1e6, 0, 0}}}, "start");
  refuses({environment, usual, {.latency = std::numeric_limits<double>::quiet_NaN()}}, "latency");
  refuses({environment, usual, {.threads = 0}}, "threads");
  HardwareConditions lost{.dropout = 2};
  refuses({environment, usual, {.hardware = lost}}, "dropout");
  lost = {};
  lost.localiser.beams = 0;
  refuses({environment, usual, {.hardware = lost}}, "beams");
  refuses({course("wren", Protocol::published), usual, {.hardware = HardwareConditions{}}}, "hardware");
  auto three = usual;
  for (SolverOptions& method : three.configuration.methods)
    if (std::string_view(method.method()) == "mppi") *method.find<PerInput>("variance") = {0.1, 0.2, 0.3};
  refuses({environment, three}, "variance");
}

TEST(LapSeeds, AreThoseOfTheProtocol) {
  EXPECT_EQ(lap_seed(0, 0, 5), 0u);
  EXPECT_EQ(lap_seed(0, 3, 5), 30u);
  EXPECT_EQ(lap_seed(7, 2, 0), 17u);
  EXPECT_NE(solver_seed(0, "mppi"), solver_seed(0, "svg_mppi"));
  EXPECT_NE(solver_seed(0, "mppi"), solver_seed(1, "mppi"));
}

}  // namespace
}  // namespace slalom::evaluation
