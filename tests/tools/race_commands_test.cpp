// `slalom race`, alone and with several cars, and `slalom racing-benchmark`: tables, results,
// pictures, and bad input named in words.

#include <set>

#include "slalom/maps/ros_map.hpp"
#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

class RaceCommand : public testing::ProgramTest {
 protected:
  /// Drives on the smallest course with few samples, unless the arguments say otherwise.
  std::string race(const std::string& arguments) const {
    return succeed("race --course wren --config default --set samples=256 " + arguments);
  }
};

TEST_F(RaceCommand, TellsFlyingLapsFromStandingStarts) {
  expect_says(race("--laps 2 --seed 2 --json r.json --plot r.png"),
              {"profile from rest", "1 standing", "2 flying", "flying laps", "standing starts",
               "behind profile", "picture: r.png"});
  EXPECT_EQ(testing::content(folder_ / "r.png").substr(1, 3), "PNG");
  const json r = result("r.json");
  ASSERT_EQ(r["laps"].size(), 2u);
  double best = 1e9;
  for (const json& lap : r["laps"]) {
    EXPECT_EQ(lap["end"], "completed");
    EXPECT_EQ(lap["start"], lap["lap"] == 1 ? "standing" : "flying");
    double sectors = 0;
    for (const json& time : lap["sectors"]) sectors += time.get<double>();
    EXPECT_NEAR(sectors, lap["time"].get<double>(), 1e-9);
    EXPECT_NEAR(lap["samples"]["time_s"].back().get<double>(), lap["time"].get<double>(), 1e-6);
    EXPECT_GT(lap["grip_p99"].get<double>(), lap["grip_p50"].get<double>());
    EXPECT_NEAR(lap["samples"]["distance_m"].back().get<double>(), r["length_m"].get<double>(), 1e-4);
    if (lap["start"] == "flying") best = std::min(best, lap["time"].get<double>());
  }
  const json &standing = r["laps"][0]["samples"]["speed_mps"], &flying = r["laps"][1]["samples"]["speed_mps"];
  EXPECT_EQ(standing[0], 0);
  EXPECT_EQ(flying[0], standing.back()) << "the car goes on";
  EXPECT_EQ(r["flying"]["completed"], 1);
  EXPECT_EQ(r["flying"]["best"], best);
  EXPECT_LE(r["flying"]["ideal"].get<double>(), best);
  EXPECT_EQ(r["standing"]["best_lap"], 1);
  EXPECT_NEAR(r["friction_circle_mps2"].get<double>(), 0.9 * 9.81, 1e-9);
}

TEST_F(RaceCommand, TheGripCircleIsThatOfTheFrictionAndTyresSaturateUnlessTheirOptionSaysOtherwise) {
  const auto beyond = [&](const std::string& friction, bool saturating) {
    race("--laps 1 --json r.json --friction " + friction);
    const json r = result("r.json");
    EXPECT_EQ(r["settings"]["options"]["world"]["saturating_tyres"], saturating);
    return r["standing"]["beyond_grip"].get<double>();
  };
  EXPECT_GT(beyond("0.05", true), 0.8);
  EXPECT_EQ(beyond("9 --set world.saturating_tyres=false", false), 0);
}

TEST_F(RaceCommand, LapsThatAreNotCompletedCount) {
  const auto run = program(
      "race --course wren --config default --set samples=256 --laps 2 --latency-ms 500 --json r.json "
      "--plot r.png");
  EXPECT_EQ(run.status, 1) << run.output;
  expect_says(run.output, {"standing starts  ", "collision after", "no picture, since no lap was completed"});
  const json r = result("r.json");
  EXPECT_EQ(r["standing"]["laps"], 2);
  EXPECT_EQ(r["standing"]["completed"], 0);
  EXPECT_TRUE(r["standing"]["mean"].is_null());
  for (const json& lap : r["laps"]) {
    EXPECT_EQ(lap["end"], "collision");
    EXPECT_EQ(lap["start"], "standing");
    EXPECT_TRUE(lap["time"].is_null());
  }
  EXPECT_NE(r["laps"][0]["seed"], r["laps"][1]["seed"]);
}

class GridRaceCommand : public testing::ProgramTest {
 protected:
  /// Races on the smallest course with few samples, unless the arguments say otherwise.
  std::string race(const std::string& arguments) const {
    return succeed("race --course wren --config default_kinematic --method mppi --set samples=64 --laps 1 " +
                   arguments);
  }
  json repeatable(const std::string& file) const {
    json read = result(file);
    read["settings"].erase("threads");
    read.erase("solve_ms");
    return read;
  }
};

TEST_F(GridRaceCommand, SaysWhoWonAndWhoHitWhom) {
  testing::expect_says(race("--cars 3 --seed 4 --json r.json"),
                       {"1 race of 3 cars on wren, 1 lap of", "car ", "default_kinematic 1",
                        "default_kinematic 3", "all cars:", "per 100 km"});
  const json r = result("r.json");
  ASSERT_EQ(r["races"].size(), 1u);
  const json& race = r["races"][0];
  EXPECT_EQ(race["seed"], 4);
  EXPECT_EQ(race["interrupted"], false);
  ASSERT_EQ(race["standings"].size(), 3u);
  EXPECT_EQ(r["settings"]["options"]["world"]["saturating_tyres"], true);
  std::set<int> grid;
  double kilometres = 0, before = 0;
  int caused = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const json& car = race["standings"][i];
    EXPECT_EQ(car["place"], i + 1);
    grid.insert(car["grid_place"].get<int>());
    kilometres += 1e-3 * car["distance"].get<double>();
    caused += car["contacts_caused"].get<int>();
    if (car["end"] != "finished") continue;
    EXPECT_EQ(car["laps"], 1);
    EXPECT_GE(car["time"].get<double>(), before);
    before = car["time"];
    EXPECT_NEAR(car["gap"].get<double>(), before - race["standings"][0]["time"].get<double>(), 1e-9);
  }
  EXPECT_EQ(race["standings"][0]["end"], "finished");
  EXPECT_EQ(grid, (std::set<int>{1, 2, 3}));
  EXPECT_EQ(caused, static_cast<int>(race["contacts"].size()));
  const json& all = r["summary"]["all"];
  EXPECT_NEAR(all["driven"].get<double>(), kilometres, 1e-9);
  EXPECT_NEAR(all["caused_per_100_km"].get<double>(), 100 * caused / kilometres, 1e-6);
  EXPECT_LE(all["caused_per_100_km_ci"][0], all["caused_per_100_km"]);
}

TEST_F(GridRaceCommand, EveryCarTracksTheOthers) {
  const auto distances = [&](const std::string& tracking) {
    race("--cars 3 --seed 4 --json r.json" + tracking);
    const json standings = result("r.json")["races"][0]["standings"];
    std::vector<double> each;
    for (const json& car : standings) each.push_back(car["distance"]);
    return each;
  };
  const auto automatic = distances("");
  EXPECT_EQ(automatic, distances(" --set world.tracking=exact"));
  EXPECT_NE(automatic, distances(" --set world.tracking=off"));
}

TEST_F(GridRaceCommand, CarsChangePlacesAndRacesInParallelAreTheSame) {
  const std::string two = "--against default_speed:svg_mppi --set world.tracking=off --races 2 ";
  race(two + "--json one.json");
  testing::expect_says(race(two + "--jobs 2 --threads 2 --json two.json"), {"race 2:"});
  const json r = repeatable("two.json");
  EXPECT_EQ(r, repeatable("one.json"));
  ASSERT_EQ(r["races"].size(), 2u);
  for (const json& race : r["races"])
    for (const json& car : race["standings"])
      EXPECT_EQ(car["grid_place"] == 1, (car["car"] == "default_kinematic:mppi") == (race["race"] == 1));
  EXPECT_EQ(r["settings"]["cars"][1]["config"], "default_speed");
  EXPECT_EQ(r["settings"]["cars"][1]["method"], "svg_mppi");
  EXPECT_EQ(r["summary"]["cars"][0]["races"], 2);
}

TEST_F(GridRaceCommand, NamesWhatDoesNotGoTogether) {
  expect_refused("race --cars 5", {"--cars", "5"});
  expect_refused("race --cars 2 --against default --against race", {"--cars", "2 must be at least 3"});
  expect_refused("race --against no_such", {"no_such"});
  expect_refused("race --against race:no_such", {"no_such", "svg_mppi"});
  expect_refused("race --races 2", {"--races", "needs --cars or --against"});
  expect_refused("race --cars 2 --standing", {"--standing", "laps against the clock"});
  expect_refused("race --cars 2 --plot r.png", {"--plot", "laps against the clock"});
  expect_refused("race --cars 2 --course wren --obstacles 2", {"obstacles: 2 must be 0"});
  expect_refused("race --cars 2 --course wren --evaluation published --config published", {"published"});
}

constexpr double pi = 3.14159265358979323846, radius = 8;

class RacingCommand : public testing::ProgramTest {
 protected:
  /// A ring through the origin of the map frame, along +x there, under the names of the four maps; two of
  /// them in folders of their own.
  void SetUp() override {
    maps::OccupancyGrid grid{400, 400, 0.05, {-10, -2, 0}, {}};
    for (int row = 0; row < grid.height; ++row)
      for (int column = 0; column < grid.width; ++column) {
        const double away = std::hypot(-10 + 0.05 * (column + 0.5), -10 + 0.05 * (row + 0.5));
        grid.cells.push_back(std::abs(away - radius) < 1 ? maps::Occupancy::free : maps::Occupancy::occupied);
      }
    std::string line = "0,0,1,1\n";
    for (int i = 0; i < 250; ++i)
      line += std::to_string(radius * std::sin(2 * pi * i / 251)) + "," +
              std::to_string(radius - radius * std::cos(2 * pi * i / 251)) + ",1,1\n";
    for (const std::string name : {"aut", "esp", "gbr", "mco"}) {
      const fs::path folder = folder_ / "maps" / (name < "g" ? name : "");
      fs::create_directories(folder);
      maps::save_ros_map(grid, folder / (name + ".yaml"));
      std::ofstream(folder / (name + "_centerline.csv")) << line;
    }
  }
  nlohmann::json drive(const std::string& arguments) const {
    succeed("racing-benchmark maps --quick --json r.json " + arguments);
    return result("r.json");
  }
};

TEST_F(RacingCommand, AnyDriverDrivesEveryMapOnTheRacelineOfItsCar) {
  // The limit of the planner's speed bounds the lap time from below: 2 pi r / v.
  const std::string arguments = "--driver mppi --set mppi.samples=400 --set planner.max_speed=4";
  const auto planned = drive(arguments);
  EXPECT_EQ(planned["config"], "racing_benchmark");
  EXPECT_EQ(planned["margin_m"], 0.12);
  const auto gap = drive("--driver follow_the_gap");
  for (const char* map : {"aut", "esp", "gbr", "mco"}) {
    for (const auto& results : {planned["maps"][map], gap["maps"][map]}) {
      EXPECT_EQ(results["laps"], 1) << map;
      EXPECT_EQ(results["completed"], 1) << map;
      EXPECT_EQ(results["at_time_limit"], 0) << map;
      EXPECT_EQ(results["lap_times"].size(), 1u) << map;
      EXPECT_EQ(results["mean"], results["lap_times"][0]) << map;
      EXPECT_GE(results["beyond_grip"].get<double>(), 0) << map;
      EXPECT_LE(results["beyond_grip"].get<double>(), 1) << map;
    }
    EXPECT_GT(planned["maps"][map]["mean"].get<double>(), 2 * pi * (radius - 1) / 4) << map;
    EXPECT_LT(planned["maps"][map]["mean"].get<double>(), 2 * pi * radius / 3) << map;
    EXPECT_EQ(gap["maps"][map], gap["maps"]["aut"]) << "the four maps are the same";
  }
  // The line of a wide car keeps further from the inner wall, so its circle is longer.
  std::ofstream(folder_ / "wide.yaml") << "vehicle: {body_width: 1.4}\n";
  const auto wide = drive(arguments + " --car wide.yaml");
  EXPECT_EQ(wide["car"], "wide.yaml");
  for (const char* map : {"aut", "mco"})
    EXPECT_GT(wide["maps"][map]["mean"].get<double>(), planned["maps"][map]["mean"].get<double>() + 0.3)
        << map;
}

TEST_F(RacingCommand, SaysWhatIsWrong) {
  expect_refused("racing-benchmark maps --car tractor", {"--car: tractor", "default"});
  expect_refused("racing-benchmark nowhere", {"nowhere", "aut.yaml"});
  expect_refused("racing-benchmark maps --driver tortoise", {"tortoise", "svg_mppi"});
  expect_refused("racing-benchmark maps --margin 2.25", {"no closed way", "1.055"});
}

}  // namespace
}  // namespace slalom::tools
