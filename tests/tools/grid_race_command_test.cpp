// `slalom race` with several cars: standings, results, who races, and bad input named in words.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

using nlohmann::json;
using testing::content;

class GridRaceCommand : public testing::ProgramTest {
 protected:
  /// Races on the smallest course with few samples, unless the arguments say otherwise.
  testing::Run race(const std::string& arguments) const {
    return program("race --course wren --config default_kinematic --method mppi --set samples=64 --laps 1 " +
                   arguments);
  }
  json result(const std::string& file) const {
    json read = json::parse(content(folder_ / file));
    read["settings"].erase("threads");
    read.erase("solve_ms");
    return read;
  }
  static bool says(const testing::Run& run, const std::string& words) {
    return run.output.find(words) != std::string::npos;
  }
};

TEST_F(GridRaceCommand, SaysWhoWonAndWhoHitWhom) {
  const auto run = race("--cars 3 --seed 4 --json r.json");
  EXPECT_EQ(run.status, 0) << run.output;
  for (const char* words : {"1 race of 3 cars on wren, 1 lap of", "place  car", "default_kinematic 1",
                            "default_kinematic 3", "all cars:", "per 100 km"})
    EXPECT_TRUE(says(run, words)) << words << " in " << run.output;
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
    kilometres += 1e-3 * car["distance_m"].get<double>();
    caused += car["contacts_caused"].get<int>();
    if (car["end"] != "finished") continue;
    EXPECT_EQ(car["laps"], 1);
    EXPECT_GE(car["time_s"].get<double>(), before);
    before = car["time_s"];
    EXPECT_NEAR(car["gap_s"].get<double>(), before - race["standings"][0]["time_s"].get<double>(), 1e-9);
  }
  EXPECT_EQ(race["standings"][0]["end"], "finished");
  EXPECT_EQ(grid, (std::set<int>{1, 2, 3}));
  EXPECT_EQ(caused, static_cast<int>(race["contacts"].size()));
  const json& all = r["summary"]["all"];
  EXPECT_NEAR(all["distance_km"].get<double>(), kilometres, 1e-9);
  EXPECT_NEAR(all["caused_per_100_km"].get<double>(), 100 * caused / kilometres, 1e-6);
  EXPECT_LE(all["caused_per_100_km_ci"][0], all["caused_per_100_km"]);
}

TEST_F(GridRaceCommand, EveryCarTracksTheOthers) {
  const auto distances = [&](const std::string& tracking) {
    EXPECT_EQ(race("--cars 3 --seed 4 --json r.json" + tracking).status, 0);
    const json standings = result("r.json")["races"][0]["standings"];
    std::vector<double> each;
    for (const json& car : standings) each.push_back(car["distance_m"]);
    return each;
  };
  const auto automatic = distances("");
  EXPECT_EQ(automatic, distances(" --set world.tracking=exact"));
  EXPECT_NE(automatic, distances(" --set world.tracking=off"));
}

TEST_F(GridRaceCommand, CarsChangePlacesAndRacesInParallelAreTheSame) {
  ASSERT_EQ(
      race("--against default_speed:svg_mppi --set world.tracking=off --races 2 --json one.json").status, 0);
  const auto run = race(
      "--against default_speed:svg_mppi --set world.tracking=off --races 2 --jobs 2 "
      "--threads 2 --json two.json");
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_TRUE(says(run, "race 2:")) << run.output;
  const json r = result("two.json");
  EXPECT_EQ(r, result("one.json"));
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

}  // namespace
}  // namespace slalom::tools
