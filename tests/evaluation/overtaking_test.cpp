// Opponents in laps: who is met, overtaken and hit, and whose fault it was.
#include <gtest/gtest.h>

#include "evaluation/courses.hpp"
#include "evaluation/overtaking/overtaking_meter.hpp"
#include "sim/rooms.hpp"
#include "slalom/evaluation/lap_table.hpp"

namespace slalom::evaluation {
namespace {

/// How a car drives.
struct Drive {
  double from = 0;      ///< m along the ring
  double left = 0;      ///< m
  double speed = 0;     ///< m/s
  double sideways = 0;  ///< m/s, to the left
  double weaving = 0;   ///< m to the left, then as far to the right, in 2 s
};

/// Meters two cars that drive like this for a time (s), or until the lap times out then.
OvertakingRecord record_of(const Drive& own, const Drive& other, double time, bool timed_out = false) {
  sim::World world({}, testing::ring_track());
  const auto at = [](const Drive& drive, double t) {
    const double woven = drive.weaving * std::sin(std::numbers::pi * t);
    return on_ring(drive.from + drive.speed * t, drive.left + drive.sideways * t + woven, drive.speed,
                   drive.sideways);
  };
  const auto start = [&](const Drive& drive) {
    const sim::CarState state = at(drive, 0);
    return maps::Pose{state.x, state.y, state.yaw};
  };
  world.reset(1, std::array{start(own), start(other)});
  OvertakingMeter meter(world);
  for (int k = 1; k * 0.01 <= time; ++k) {
    world.follow(std::array{at(own, 0.01 * k), at(other, 0.01 * k)});
    meter.update(world);
  }
  return meter.record(timed_out);
}

TEST(Overtaking, IsOverWhenTheOpponentIsBehind) {
  const OvertakingRecord record =
      record_of({.left = 0.5, .speed = 4}, {.from = 6, .left = -0.5, .speed = 2}, 6);
  ASSERT_EQ(record.encounters.size(), 1U);
  const Encounter& met = record.encounters[0];
  EXPECT_EQ(met.opponent, 0);
  EXPECT_NEAR(met.time, 1.0, 0.1) << "from 6 m to 4 m";
  EXPECT_NEAR(met.duration, 2.5, 0.1) << "from 4 m to -1 m";
  EXPECT_EQ(met.end, EncounterEnd::overtaken);
  EXPECT_EQ(record.contacts, 0);
}

TEST(Overtaking, ACarThatStaysBehindForTwoRoundsHasNotOvertaken) {
  const Drive other{.from = 3, .speed = 6};
  EXPECT_EQ(record_of({.speed = 6}, other, 10).encounters.at(0).end, EncounterEnd::open);
  EXPECT_EQ(record_of({.speed = 6}, other, 11.6).encounters.at(0).end, EncounterEnd::not_overtaken);
}

TEST(Overtaking, ALapThatTimesOutEndsTheEncountersThatAreOpen) {
  const Drive own{.left = 0.5, .speed = 4}, other{.from = 6, .left = -0.5, .speed = 2};
  EXPECT_EQ(record_of(own, other, 2).encounters.at(0).end, EncounterEnd::open);
  EXPECT_EQ(record_of(own, other, 2, true).encounters.at(0).end, EncounterEnd::not_overtaken);
  EXPECT_EQ(record_of(own, other, 6, true).encounters.at(0).end, EncounterEnd::overtaken) << "before that";
}

TEST(Overtaking, AnOpponentThatIsLappedIsMetAgain) {
  const OvertakingRecord record =
      record_of({.left = 0.5, .speed = 8}, {.from = 6, .left = -0.5, .speed = 2}, 8);
  ASSERT_EQ(record.encounters.size(), 2U);
  EXPECT_EQ(record.encounters[1].end, EncounterEnd::overtaken);
}

TEST(Overtaking, ChangesOfSideAreCountedBehindAndBesideTheOpponent) {
  const auto changes = [](const Drive& own, const Drive& other, double time) {
    return record_of(own, other, time).encounters.at(0).side_changes;
  };
  const Drive ahead{.from = 2, .speed = 3};
  EXPECT_EQ(changes({.speed = 3, .weaving = 0.5}, ahead, 4), 3) << "left, right, left, right";
  EXPECT_EQ(changes(ahead, {.from = 4, .speed = 3, .weaving = 0.5}, 4), 3) << "if the opponent does it, too";
  EXPECT_EQ(changes({.speed = 3, .weaving = 0.25}, ahead, 4), 0) << "less than a car's width";
  EXPECT_EQ(changes({.left = 0.5, .speed = 3, .weaving = 0.7}, ahead, 4), 0) << "behind it and back";
}

TEST(Overtaking, ChangesOfSideDoNotCountFarBehind) {
  const Drive own{.left = -0.5, .speed = 2, .sideways = 0.5};
  EXPECT_EQ(record_of(own, {.from = 3, .speed = 2}, 2).encounters.at(0).side_changes, 1);
  EXPECT_EQ(record_of(own, {.from = 3, .speed = 4}, 2).encounters.at(0).side_changes, 0)
      << "6.2 m behind when it is on the left";
}

TEST(Overtaking, TheCarBehindIsAtFault) {
  const OvertakingRecord into = record_of({.speed = 4}, {.from = 3, .speed = 2}, 2);
  EXPECT_EQ(into.contacts, 1);
  EXPECT_EQ(into.caused, 1);
  EXPECT_EQ(into.encounters.at(0).caused, 1);
  const OvertakingRecord hit = record_of({.from = 3, .speed = 2}, {.speed = 4}, 2);
  EXPECT_EQ(hit.contacts, 1);
  EXPECT_EQ(hit.caused, 0);
}

TEST(Overtaking, AlongsideTheCarThatMovesAcrossIsAtFault) {
  const Drive steady{.left = 0.3, .speed = 3};
  const auto caused = [](const OvertakingRecord& record) {
    EXPECT_EQ(record.contacts, 1);
    return record.caused;
  };
  for (const double ahead : {-0.2, 0.0, 0.2}) {
    const Drive right_of{.from = ahead, .left = -0.3, .speed = 3, .sideways = 0.5};
    EXPECT_EQ(caused(record_of(steady, right_of, 0.8)), 0) << ahead;
    EXPECT_EQ(caused(record_of(right_of, steady, 0.8)), 1) << ahead;
  }
}

LapSetup setup_with(const LapSettings& settings, const std::string& method = "mppi") {
  static const auto environment = course("wren");
  return {environment, {configuration("default_kinematic", 64), method}, settings};
}

LapResult lap_with(const LapSettings& settings, std::uint64_t seed = 1) {
  return run_lap(setup_with(settings), seed);
}

TEST(Overtaking, OpponentsAreInALapAndItRepeats) {
  const LapSettings settings{.obstacles = 2,
                             .opponents = 3,
                             .opponent_speed = PerInput{0.5, 0.6, 0.7},
                             .opponent_driver = sim::OpponentDriver::erratic,
                             .opponent_gap = 3,
                             .tracking = TrackingMode::exact};
  const LapResult first = lap_with(settings), again = lap_with(settings), other = lap_with(settings, 2);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(first.state_cost), std::bit_cast<std::uint64_t>(again.state_cost));
  EXPECT_EQ(first.time, again.time);
  EXPECT_NE(first.state_cost, other.state_cost);
  ASSERT_FALSE(first.overtaking.encounters.empty());
  EXPECT_LT(first.overtaking.encounters[0].time, 0.1) << "the first opponent starts 3 m ahead";
  EXPECT_EQ(first.overtaking.encounters.size(), again.overtaking.encounters.size());
  const LapRow row = make_row(0, 0, first, 1);
  EXPECT_EQ(row.overtaking.met, static_cast<int>(first.overtaking.encounters.size()));
  EXPECT_EQ(row.overtaking.contacts, first.overtaking.contacts);
  EXPECT_EQ(row.overtaking.caused, first.overtaking.caused);
}

/// m along the course that the opponent of a lap has driven after `time` (s). It starts half the course
/// ahead: for the first seconds, neither car sees the other.
double way_of_opponent(const LapSettings& settings, double time, const std::string& method = "mppi") {
  double way = 0;
  std::atomic<bool> enough = false;
  run_lap(
      setup_with(settings, method), 1,
      [&](const ControlStep& step) {
        way = step.world.laps(1)->progress();
        enough = step.time >= time;
      },
      &enough);
  return way;
}

TEST(Overtaking, AnOpponentWithAPlannerDrivesAtItsShareOfTheSpeed) {
  const auto way = [](double share, bool fastest) {
    LapSettings settings{.opponents = 1, .opponent_speed = share, .planning_opponents = 1};
    settings.saturating_tyres = fastest;
    if (fastest) settings.opponent_planner = std::make_shared<Driver>(Driver{configuration("race", 0)});
    return way_of_opponent(settings, 1.5);
  };
  const double all = way(1, false), all_fastest = way(1, true);
  EXPECT_GT(all, 3);
  EXPECT_GT(all_fastest, 3);
  for (const double share : {0.5, 0.7}) {
    EXPECT_NEAR(way(share, false) / all, share, 0.12) << share;
    EXPECT_NEAR(way(share, true) / all_fastest, share, 0.2) << share << ", for the shortest time";
  }
  EXPECT_THROW(way(0.4, true), std::invalid_argument) << "less than vehicle.speed_share can be";
}

TEST(Overtaking, OpponentsCanHaveAPlannerThatDoesNotDependOnTheCar) {
  LapSettings settings{.opponents = 1, .opponent_speed = 1, .planning_opponents = 1};
  const auto way = [&](const char* method) { return way_of_opponent(settings, 2, method); };
  EXPECT_NE(way("mppi"), way("svg_mppi")) << "that of the car";
  Driver slow{configuration("default_kinematic", 64), "mppi"};
  slow.configuration.planner.max_speed = 0.5;
  settings.opponent_planner = std::make_shared<Driver>(slow);
  const double way_of_slow = way("mppi");
  EXPECT_EQ(way_of_slow, way("svg_mppi"));
  slow.configuration.planner.control_period = 0.05;
  settings.opponent_planner = std::make_shared<Driver>(slow);
  EXPECT_EQ(way_of_slow, way("mppi")) << "at the control period of the car";
  EXPECT_GT(way_of_slow, 0.4);
  EXPECT_LT(way_of_slow, 1.1);
}

TEST(Overtaking, ALapCanHaveSeveralRounds) {
  const LapResult one = lap_with({}), two = lap_with({.rounds = 2});
  ASSERT_TRUE(one.finished && two.finished);
  EXPECT_GT(two.time, 1.8 * one.time);
  EXPECT_LT(two.time, 2.1 * one.time);
  EXPECT_TRUE(one.overtaking.encounters.empty());
}

TEST(Overtaking, SettingsThatDoNotFitAreRefused) {
  EXPECT_THROW(lap_with({.opponents = 2, .opponent_speed = PerInput{0.5, 0.6, 0.7}}), std::invalid_argument);
  EXPECT_THROW(lap_with({.opponents = 1, .planning_opponents = 2}), std::invalid_argument);
  EXPECT_THROW(lap_with({.opponents = 5, .planning_opponents = 5}), std::invalid_argument);
  EXPECT_THROW(lap_with({.rounds = 0}), std::invalid_argument);
}

auto figures_of(const LapRow& row) {
  const OvertakingFigures& f = row.overtaking;
  return std::tuple(f.met, f.overtaken, f.not_overtaken, f.duration, f.contacts, f.caused, f.side_changes);
}

TEST(OvertakingColumns, CountTheEncountersOfALap) {
  LapResult lap;
  lap.overtaking.encounters = {{.duration = 3, .end = EncounterEnd::overtaken},
                               {.duration = 8, .end = EncounterEnd::not_overtaken, .side_changes = 3},
                               {.duration = 6, .end = EncounterEnd::overtaken, .side_changes = 1},
                               {.duration = 1, .end = EncounterEnd::open}};
  lap.overtaking.contacts = 5;
  lap.overtaking.caused = 2;
  EXPECT_EQ(figures_of(make_row(0, 0, lap, 1)), std::tuple(4, 2, 1, 4.5, 5, 2, 4));
}

TEST(OvertakingColumns, AreThereIfAnExperimentHasOpponents) {
  std::vector<Experiment> experiments{{"mppi", {}, "pt", 0, 2}};
  EXPECT_EQ(csv_header(experiments), csv_header());
  experiments[0].set.emplace_back("world.opponents", "2");
  EXPECT_TRUE(experiments[0].has_opponents());
  EXPECT_EQ(csv_header(experiments), csv_header() +
                                         ",opponents_met,overtaken,not_overtaken,overtaking_time,"
                                         "opponent_contacts,contacts_caused,side_changes");
  LapRow row;
  row.min_clearance = 0.1;
  row.overtaking = {5, 3, 1, 4.25, 2, 1, 7};
  EXPECT_EQ(figures_of(parse_line(csv_line(row, experiments), experiments)), figures_of(row));
}

}  // namespace
}  // namespace slalom::evaluation
