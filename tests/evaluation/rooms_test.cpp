// Rooms: scenarios, drives through them, what moves in their scans, and the worlds of BARN.

#include "slalom/core/random.hpp"
#include "slalom/evaluation/rooms/mover_watch.hpp"
#include "slalom/evaluation/rooms/room_drive.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/sim/room/crowd.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::evaluation::rooms_test {
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

RoomDriver quick_driver(bool predict_movers = true) {
  SvgMppiOptions options = navigation::svg_mppi_options({});
  options.samples = 512;
  return {.solver = options, .predict_movers = predict_movers};
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

/// Each row of the table of manoeuvres, with its limits.
TEST(RoomDrive, EveryManoeuvreEndsAsItShould) {
  for (const RoomScenario& scenario : manoeuvre_scenarios()) {
    const RoomDrive drive = drive_room(scenario, {.solver = navigation::svg_mppi_options(scenario.base)}, 1);
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
      SvgMppiOptions longer = navigation::svg_mppi_options(scenario.base);
      longer.horizon = 200;
      EXPECT_LT(drive_room(scenario, {.solver = longer}, 1).command_change, 0.01) << "0.015 with wider noise";
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
  expect_error_with<std::invalid_argument>({"seedless", "seed"}, [] {
    drive_room(room_scenario("pallet-on-path"), {.solver = SeedlessOptions{}}, 1);
  });
}

constexpr int beams = 240;
constexpr double period = 0.05, max_range = 16;  // s, m

/// A scanner in a room of 10 x 6 m with a pallet.
struct Scanner {
  sim::Room room{10, 6, {}, {{{7, 1.5, 0.2}, 1.2, 0.8}}};
  MoverWatch watch{beams};
  RandomStream random{{5, 0}};
  std::vector<double> ranges = std::vector<double>(beams);
  double time = 0;

  std::span<const maps::PredictedObstacle> look(const maps::Pose& from) {
    sim::scan(room, from, max_range, ranges);
    for (double& range : ranges)
      if (range < max_range) range += 0.01 * random.normal();
    time += period;
    return watch.update({from, ranges, max_range}, time);
  }
};

TEST(MoverWatch, PredictsSomebodyWhoWalks) {
  for (const bool ahead : {true, false}) {
    Scanner scanner;
    const sim::Walker walker{{ahead ? maps::Point{6, 3} : maps::Point{4, 5}, {2.8, 3.4}}, 0.8};
    sim::Crowd crowd(scanner.room, {walker});
    int predicted = 0, scans = 0;
    for (int i = 0; i < 50; ++i) {
      for (int k = 0; k < 5; ++k) crowd.step(period / 5, {{1, 1, 0}, 0.7, 0.5}, {});
      const sim::Disc& body = crowd.bodies()[0];
      scanner.room.people = {body};
      const auto others = scanner.look({2, 3, 0});
      const maps::Point& v = crowd.velocities()[0];
      if (i < 16 || std::hypot(v.x, v.y) < 0.5) continue;
      ++scans;
      for (const maps::PredictedObstacle& each : others) {
        const maps::Pose now = each.at(0, 0).pose, then = each.at(0, 1).pose;
        EXPECT_LT(std::hypot(now.x - body.middle.x, now.y - body.middle.y), 0.3) << i;
        if (std::hypot(then.x - body.middle.x - v.x, then.y - body.middle.y - v.y) < 0.5) ++predicted;
      }
      if (others.empty()) continue;
      const navigation::RangeScan left = scanner.watch.without_movers();
      for (std::size_t b = 0; b < left.ranges.size(); ++b) {
        const double angle = 2 * 3.141592653589793 * static_cast<double>(b) / beams;
        const double x = 2 + scanner.ranges[b] * std::cos(angle), y = 3 + scanner.ranges[b] * std::sin(angle);
        if (std::hypot(x - body.middle.x, y - body.middle.y) < 0.25) {
          EXPECT_TRUE(std::isnan(left.ranges[b])) << i;
        } else if (std::hypot(x - body.middle.x, y - body.middle.y) > 0.9) {
          EXPECT_EQ(left.ranges[b], scanner.ranges[b]) << i;
        }
      }
    }
    EXPECT_GE(scans, 20);
    EXPECT_GE(predicted, 0.8 * scans) << ahead;
  }
}

TEST(MoverWatch, PalletsAndWallsDoNotMove) {
  Scanner scanner;
  scanner.room.walls = {{{4, 4, 0}, 0.2, 3}};
  for (int i = 0; i < 200; ++i) {
    const double turn = 0.4 * std::sin(0.05 * i);
    EXPECT_TRUE(scanner.look({1 + 0.025 * i, 2.5 - 0.5 * std::sin(0.02 * i), turn}).empty()) << i;
  }
}

TEST(RoomDrive, WithoutPeopleItIsTheSameWithAndWithoutWatchingForThem) {
  const RoomDrive a = drive_room(room_scenario("pallet-on-path"), quick_driver(), 2),
                  b = drive_room(room_scenario("pallet-on-path"), quick_driver(false), 2);
  ASSERT_EQ(a.trace.size(), b.trace.size());
  EXPECT_EQ(a.trace.back().x, b.trace.back().x);
  EXPECT_EQ(a.length, b.length);
}

TEST(RoomDrive, WaitsForOrPassesSomebodyWhoCrosses) {
  const RoomDrive drive = drive_room(room_scenario("crossing-walker"), {}, 101);
  EXPECT_EQ(drive.outcome, RoomOutcome::reached);
  ASSERT_EQ(drive.people.size(), 1u);
  EXPECT_EQ(drive.people[0].size(), drive.trace.size());
  EXPECT_LT(drive.people[0].back().y, 1) << "the walker has crossed";
}

std::string cylinder(double x, double y) {
  const std::string pose = std::to_string(x) + " " + std::to_string(y) + " 0 0 0 0";
  return "<model name='unit_cylinder_1'>\n<pose frame=''>" + pose +
         "</pose>\n<radius>0.075000</radius>\n<radius>0.075000</radius>\n</model>\n";
}

/// An array of numpy with the cells (15, 0) and (15, 29).
std::string path_file() {
  std::string header = "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 2), }";
  header.resize(69, ' ');
  std::string bytes = std::string("\x93NUMPY\x01\0", 8) + char(header.size() + 1) + '\0' + header + '\n';
  for (const int value : {15, 0, 15, 29}) bytes += char(value) + std::string(7, '\0');
  return bytes;
}

TEST(BarnScenarios, HaveThePostsAndTheOptimalTimeOfTheirFiles) {
  const testing::ScopedFolder folder;
  folder.write("world_0.world", "<pose frame=''>0 0 10 0 -0 0</pose>" + cylinder(-2.4, 8) + cylinder(-1, 7) +
                                    "<state><model name='unit_cylinder_1'><pose frame=''>0 0 0</pose>");
  std::filesystem::create_directory(folder.path() / "path_files");
  folder.write("path_files/path_0.npy", path_file());
  const auto scenarios = barn_scenarios(folder.path(), 300);
  ASSERT_EQ(scenarios.size(), 1u);
  const RoomScenario& world = scenarios[0];
  EXPECT_EQ(world.name, "barn-0");
  ASSERT_EQ(world.room.posts.size(), 2u);
  EXPECT_NEAR(world.goal.y - world.start.y, 10, 1e-12);
  EXPECT_NEAR(world.room.posts[0].middle.x - world.start.x, -0.15, 1e-9);
  EXPECT_NEAR(world.room.posts[0].middle.y - world.start.y, 5, 1e-9);
  // From (-2.25, 3) to (-2.325, 5.075), (-2.325, 9.425) and (-2.25, 13).
  EXPECT_NEAR(world.optimal_time, (std::hypot(0.075, 2.075) + 4.35 + std::hypot(0.075, 3.575)) / 2, 1e-9);
  const RoomDrive drive = drive_room(
      world, {.solver = navigation::svg_mppi_options(world.base), .predict_movers = false}, 1, 100);
  EXPECT_EQ(drive.outcome, RoomOutcome::reached);
  EXPECT_LT(drive.goal_distance, 1);
  EXPECT_DOUBLE_EQ(drive.metric, 0.5) << "it takes less than two optimal times";
}

TEST(BarnScenarios, RefuseFilesOfAnotherFormat) {
  const testing::ScopedFolder folder;
  expect_error_with<std::runtime_error>({"world_0.world"}, [&] { barn_scenarios(folder.path(), 6); });
  folder.write("world_0.world", "<model name='unit_cylinder_1'> <pose frame=''>a");
  expect_error_with<std::runtime_error>({"world_0.world", "a number after <pose"},
                                        [&] { barn_scenarios(folder.path(), 6); });
  folder.write("world_0.world", cylinder(0, 0));
  std::filesystem::create_directory(folder.path() / "path_files");
  folder.write("path_files/path_0.npy", "1 2 3");
  expect_error_with<std::runtime_error>({"path_0.npy", "numpy"}, [&] { barn_scenarios(folder.path(), 6); });
}

}  // namespace
}  // namespace slalom::evaluation::rooms_test
