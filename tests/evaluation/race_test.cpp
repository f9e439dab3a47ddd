// Laps against the clock: where they begin and end, what is measured of them, and the lap of the profile.
#include "slalom/evaluation/race.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "evaluation/courses.hpp"

namespace slalom::evaluation {
namespace {

constexpr double grip = 8.8;  // m/s^2

LapSetup setup(const std::shared_ptr<const Environment>& environment, const LapSettings& settings = {}) {
  return {environment, {quick_configuration(), "mppi"}, settings};
}

double total(const std::array<double, racing_sectors>& sectors) {
  return std::accumulate(sectors.begin(), sectors.end(), 0.0);
}

/// A lap of 30 m: 10 m at each speed.
std::vector<RacingSample> stepped(double first, double second, double third) {
  std::vector<RacingSample> samples{{.speed = first}};
  for (const double speed : {first, second, third})
    for (int i = 0; i < 5; ++i) {
      RacingSample next = samples.back();
      next.distance += 2;
      next.time += 2 / speed;
      next.speed = speed;
      samples.push_back(next);
    }
  return samples;
}

TEST(RacingLap, SectorsAndTimesBehindAreThoseOfTheWay) {
  const auto steady = stepped(4, 4, 4), slow_middle = stepped(4, 2, 4);
  const auto sectors = sector_times(slow_middle, 30);
  EXPECT_NEAR(sectors[0], 2.5, 1e-12);
  EXPECT_NEAR(sectors[1], 5.0, 1e-12);
  EXPECT_NEAR(sectors[2], 2.5, 1e-12);
  EXPECT_NEAR(time_behind(slow_middle, steady, 10), 0, 1e-12);
  EXPECT_NEAR(time_behind(slow_middle, steady, 15), 1.25, 1e-12);
  EXPECT_NEAR(time_behind(slow_middle, steady, 29), 2.5, 1e-12);
  EXPECT_NEAR(time_behind(steady, slow_middle, 31), -2.5, 1e-12) << "beyond the end the end counts";
  EXPECT_NEAR(at_distance(steady, 3)->time, 0.75, 1e-12);
  EXPECT_FALSE(at_distance(steady, 30.5));
}

TEST(RacingLap, ASectorThatWasNotCompletedHasNoTime) {
  auto samples = stepped(4, 4, 4);
  samples.resize(9);  // to 16 m
  const auto sectors = sector_times(samples, 30);
  EXPECT_NEAR(sectors[0], 2.5, 1e-12);
  EXPECT_TRUE(std::isnan(sectors[1]) && std::isnan(sectors[2]));
}

TEST(RacingLap, ReachesAPlaceWhenItGetsThereFirst) {
  // 1 m forwards, 0.5 m back, then forwards again.
  std::vector<RacingSample> samples;
  for (const auto& [distance, time] : {std::pair(0.0, 0.0), {1.0, 1.0}, {0.5, 2.0}, {2.0, 3.0}})
    samples.push_back({.distance = distance, .time = time});
  EXPECT_NEAR(at_distance(samples, 0.75)->time, 0.75, 1e-12);
  EXPECT_NEAR(at_distance(samples, 1.25)->time, 2.5, 1e-12);
}

TEST(RacingLap, GripIsWeightedByTime) {
  // 3 m/s^2 for 6 s, 5 m/s^2 for 3 s, and the next lap with 9 m/s^2 for 1 s.
  const std::vector<RacingSample> samples{{.time = 0},
                                          {.time = 6, .longitudinal = -3},
                                          {.time = 9, .longitudinal = 3, .lateral = 4},
                                          {.time = 0},
                                          {.time = 1, .lateral = -9}};
  const GripUse use = grip_use(samples, 4);
  EXPECT_NEAR(use.p50, 3, 1e-12);
  EXPECT_NEAR(use.p99, 9, 1e-12);
  EXPECT_NEAR(use.beyond, 0.4, 1e-12);
  EXPECT_EQ(grip_use({}, 4).beyond, 0);
}

TEST(Race, TheSimulatedCarMayBeAPassengerCar) {
  LapSettings settings;
  EXPECT_TRUE(set_world_option(settings, "world.car", "passenger_car"));
  EXPECT_EQ(settings.car, CarKind::passenger_car);
  const auto environment = course("stag");
  const LapDrive small(setup(environment), 1);
  EXPECT_EQ(small.world().options().car.mass, sim::CarParameters{}.mass);
  EXPECT_THROW(LapDrive(setup(environment, settings), 1), std::invalid_argument)
      << "on a course of scale 1/10 it lies in a wall";
}

TEST(Race, AccelerationsAreThoseOfTheSpeedsAndTheCurve) {
  const auto laps = drive_race(setup(course("stag")), {.laps = 1});
  const auto& samples = laps[0].samples;
  double gained = 0, turned = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double duration = samples[i].time - samples[i - 1].time;
    gained += samples[i].longitudinal * duration;
    turned += samples[i].lateral * duration / std::max(samples[i].speed, 0.5);
  }
  EXPECT_NEAR(gained, samples.back().speed - samples.front().speed, 0.05);
  EXPECT_NEAR(std::abs(turned), 2 * 3.14159265358979, 0.25) << "a lap turns the velocity once round";
}

TEST(Race, EveryLapCanBeginWithAStandingStart) {
  LapSettings settings{.obstacles = 1};
  const auto laps = drive_race(setup(course("stag"), settings), {.laps = 2, .seed = 5, .standing = true});
  ASSERT_EQ(laps.size(), 2u);
  EXPECT_EQ(laps[0].seed, lap_seed(5, 0, 1));
  EXPECT_EQ(laps[1].seed, lap_seed(5, 1, 1));
  for (const RacingLap& lap : laps) {
    EXPECT_TRUE(lap.standing);
    EXPECT_EQ(lap.samples.front().speed, 0);
  }
}

TEST(Race, ALapEndsAfterItsTimeout) {
  const auto laps = drive_race(setup(timed_out_after(2, course("stag"))), {.laps = 2});
  ASSERT_EQ(laps.size(), 2u);
  for (const RacingLap& lap : laps) {
    EXPECT_EQ(lap.end, RacingEnd::timeout);
    EXPECT_NEAR(lap.time(), 2, 0.06);
  }
}

TEST(Race, EndsWhenItIsCancelled) {
  std::atomic<bool> cancel = false;
  const auto laps = drive_race(setup(course("stag")), {.laps = 5},
                               {.on_step = {}, .on_lap = [&](const RacingLap&) { cancel = true; }}, &cancel);
  EXPECT_EQ(laps.size(), 1u);
  EXPECT_THROW(drive_race(setup(course("stag")), {.laps = 0}), std::invalid_argument);
}

TEST(ProfileLap, TakesTheTimeOfTheProfile) {
  for (const char* name : {"stag", "wren"}) {
    const auto environment = course(name);
    const RacingLap lap = profile_lap(setup(environment), false, grip);
    EXPECT_NEAR(lap.time(), vehicle::profile_time(environment->course), 1e-6) << name;
    EXPECT_NEAR(total(lap.sector), lap.time(), 1e-9) << name;
    EXPECT_NEAR(lap.samples.back().distance, environment->course.length, 1e-9) << name;
    EXPECT_NEAR(lap.samples.back().speed, lap.samples.front().speed, 1e-6) << name;
  }
}

TEST(ProfileLap, BeginsWhereTheCarStarts) {
  const auto environment = course("stag");
  LapSettings settings;
  const vehicle::Waypoint& middle = environment->course.waypoints[environment->course.waypoints.size() / 2];
  settings.start = maps::Pose{middle.x, middle.y, middle.yaw};
  const auto first = profile_lap(setup(environment), false, grip),
             moved = profile_lap(setup(environment, settings), false, grip);
  EXPECT_NEAR(moved.time(), first.time(), 1e-3);
  EXPECT_NEAR(moved.samples.front().speed, middle.speed, 1e-6);
}

TEST(ProfileLap, FromRestItAcceleratesWithinTheGrip) {
  const auto environment = course("stag");
  const auto driver = setup(environment);
  const RacingLap flying = profile_lap(driver, false, grip), standing = profile_lap(driver, true, grip),
                  weak = profile_lap(driver, true, 2);
  EXPECT_EQ(standing.samples.front().speed, 0);
  EXPECT_GT(standing.time(), flying.time());
  EXPECT_GT(weak.time(), standing.time());
  for (std::size_t i = 1; standing.samples[i].speed < flying.samples[i].speed; ++i)
    EXPECT_LE(standing.samples[i].longitudinal, grip * (1 + 1e-9)) << i;
  EXPECT_NEAR(standing.samples.back().speed, flying.samples.back().speed, 1e-9);
  EXPECT_THROW(profile_lap(driver, true, 0), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::evaluation
