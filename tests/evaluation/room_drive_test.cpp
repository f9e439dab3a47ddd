#include "slalom/evaluation/rooms/room_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "slalom/navigation/path_planner.hpp"
#include "support/thrown_words.hpp"

namespace slalom::evaluation {
namespace {

/// The options of a method that nobody registered: it has no option `seed`.
struct SeedlessOptions {
  static constexpr const char* method = "seedless";
  int horizon = 20;
};
template <class Options, class Visit>
requires is_options_of<Options, SeedlessOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.horizon, {"horizon", "", ""});
}
std::unique_ptr<Solver> make_solver(const SeedlessOptions&, int, std::shared_ptr<ThreadPool>) {
  return nullptr;
}

RoomDriver quick_driver() {
  RoomDriver driver;
  SvgMppiOptions options = navigation::svg_mppi_options({});
  options.samples = 512;
  driver.solver = options;
  return driver;
}

TEST(RoomScenarios, StartsAndGoalsAreFreeAndThereIsAWayWhereTheySay) {
  const double length = RoomScenario{}.robot_length, width = RoomScenario{}.robot_width;
  const navigation::Footprint body = navigation::Footprint::rectangle(0.5 * length, 0.5 * length, width);
  EXPECT_EQ(room_scenarios().size(), 20u);
  for (const RoomScenario& scenario : room_scenarios()) {
    EXPECT_FALSE(sim::collides(scenario.room, {scenario.start, length, width})) << scenario.name;
    EXPECT_FALSE(sim::collides(scenario.room, {scenario.goal, length, width})) << scenario.name;
    sim::Room all = scenario.room;
    all.walls.insert(all.walls.end(), all.obstacles.begin(), all.obstacles.end());
    for (const bool with_obstacles : {false, true}) {
      const maps::OccupancyGrid map = sim::map_of(with_obstacles ? all : scenario.room, 0.05);
      navigation::Costmap costmap(map.width, map.height, map.resolution);
      costmap.update(map);
      const bool found = !plan_path(costmap, body, scenario.start, scenario.goal).empty();
      EXPECT_EQ(found, scenario.wanted != RoomOutcome::blocked || !with_obstacles) << scenario.name;
    }
    EXPECT_EQ(&room_scenario(scenario.name), &scenario);
    EXPECT_NO_THROW(sim::Crowd(scenario.room, scenario.walkers)) << scenario.name;
  }
  EXPECT_THROW(room_scenario("no such room"), std::invalid_argument);
}

TEST(RoomDrive, GoesRoundAPalletAndRepeatsExactly) {
  const RoomScenario& scenario = room_scenario("pallet-on-path");
  const RoomDrive first = drive_room(scenario, quick_driver(), 3),
                  second = drive_room(scenario, quick_driver(), 3);
  EXPECT_EQ(first.outcome, RoomOutcome::reached);
  EXPECT_TRUE(first.success);
  EXPECT_GT(first.length, 7.1) << "7 m from start to goal, and the way round";
  EXPECT_LT(first.length, 9);
  ASSERT_EQ(first.trace.size(), second.trace.size());
  EXPECT_EQ(first.trace.back().x, second.trace.back().x);
  EXPECT_EQ(first.trace.back().yaw, second.trace.back().yaw);
  const RoomDrive other = drive_room(scenario, quick_driver(), 4);
  EXPECT_NE(first.trace.front().x, other.trace.front().x);
}

TEST(RoomDrive, SaysWithinHalfASecondThatThereIsNoWay) {
  const RoomDrive drive = drive_room(room_scenario("no-way"), quick_driver(), 1);
  EXPECT_EQ(drive.outcome, RoomOutcome::blocked);
  EXPECT_TRUE(drive.success);
  EXPECT_GE(drive.answer_time, 0);
  EXPECT_LE(drive.answer_time, 0.5);
}

/// Each row of the table of manoeuvres, with its limits.
TEST(RoomDrive, EveryManoeuvreEndsAsItShould) {
  for (const RoomScenario& scenario : manoeuvre_scenarios()) {
    RoomDriver driver;
    driver.solver = navigation::svg_mppi_options(scenario.base);
    const RoomDrive drive = drive_room(scenario, driver, 1);
    EXPECT_TRUE(drive.success) << scenario.name << ": " << name(drive.outcome);
    EXPECT_EQ(&room_scenario(scenario.name), &scenario);
    const std::string_view kind = scenario.name;
    if (kind == "bay" || kind == "straight" || kind == "delay" || kind == "loop") {
      EXPECT_EQ(drive.reversals, 0) << kind;
    }
    if (kind == "rows") {
      EXPECT_LT(drive.aside, 0.1);
    }
    if (kind == "straight") {
      EXPECT_LT(drive.command_change, 0.0236);
      EXPECT_LE(drive.turn_changes, 3);
    }
    if (scenario.wanted != RoomOutcome::reached) continue;
    EXPECT_LE(drive.goal_distance, 0.11) << kind;
    EXPECT_LE(drive.goal_angle, 0.16) << kind;
  }
}

TEST(RoomDrive, EndsAtTheTimeout) {
  const RoomDrive drive = drive_room(room_scenario("pallet-on-path"), quick_driver(), 1, 2);
  EXPECT_EQ(drive.outcome, RoomOutcome::timeout);
  EXPECT_FALSE(drive.success);
  EXPECT_EQ(drive.trace.size(), 40u);
}

TEST(RoomDrive, RefusesATimeoutOutOfRangeAndASolverWithoutASeed) {
  expect_error_with<std::invalid_argument>(
      {"timeout"}, [&] { drive_room(room_scenario("pallet-on-path"), quick_driver(), 1, INFINITY); });
  RoomDriver driver;
  driver.solver = SeedlessOptions{};
  expect_error_with<std::invalid_argument>({"seedless", "seed"},
                                           [&] { drive_room(room_scenario("pallet-on-path"), driver, 1); });
}

}  // namespace
}  // namespace slalom::evaluation
