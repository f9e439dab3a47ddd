// `slalom race`: tables, results, pictures, the comparison of two runs, and bad input named in words.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::content;

class RaceCommand : public testing::ProgramTest {
 protected:
  /// Drives on the smallest course with few samples, unless the arguments say otherwise.
  testing::Run race(const std::string& arguments) const {
    return program("race --course wren --config default --set samples=256 " + arguments);
  }
  json result(const std::string& file) const { return json::parse(content(folder_ / file)); }
  static bool says(const testing::Run& run, const std::string& words) {
    return run.output.find(words) != std::string::npos;
  }
};

TEST_F(RaceCommand, TellsFlyingLapsFromStandingStarts) {
  const auto run = race("--laps 3 --seed 2 --json r.json --plot r.png");
  EXPECT_EQ(run.status, 0) << run.output;
  for (const char* words : {"profile from rest", "1 standing", "2 flying", "flying laps           2 of 2",
                            "standing starts       1 of 1", "behind profile", "picture: r.png"})
    EXPECT_TRUE(says(run, words)) << words << " in " << run.output;
  EXPECT_EQ(content(folder_ / "r.png").substr(1, 3), "PNG");
  const json r = result("r.json");
  ASSERT_EQ(r["laps"].size(), 3u);
  double best = 1e9;
  for (const json& lap : r["laps"]) {
    EXPECT_EQ(lap["end"], "completed");
    EXPECT_EQ(lap["start"], lap["lap"] == 1 ? "standing" : "flying");
    double sectors = 0;
    for (const json& time : lap["sectors_s"]) sectors += time.get<double>();
    EXPECT_NEAR(sectors, lap["time_s"].get<double>(), 1e-9);
    EXPECT_NEAR(lap["samples"]["time_s"].back().get<double>(), lap["time_s"].get<double>(), 1e-6);
    EXPECT_GT(lap["grip_p99_mps2"].get<double>(), lap["grip_p50_mps2"].get<double>());
    if (lap["start"] == "flying") best = std::min(best, lap["time_s"].get<double>());
  }
  EXPECT_EQ(r["flying"]["completed"], 2);
  EXPECT_EQ(r["flying"]["best_s"], best);
  EXPECT_LE(r["flying"]["ideal_s"].get<double>(), best);
  EXPECT_EQ(r["standing"]["best_lap"], 1);
  EXPECT_NEAR(r["friction_circle_mps2"].get<double>(), 0.9 * 9.81, 1e-9);
  EXPECT_NEAR(r["along"]["behind_profile_s"].back().get<double>(),
              best - r["profile"]["time_s"].get<double>(), 1e-6);
  EXPECT_FALSE(r.contains("compared"));
}

TEST_F(RaceCommand, TheGripCircleIsThatOfTheFriction) {
  const auto beyond = [&](const std::string& friction) {
    const auto run = race("--laps 1 --json r.json --friction " + friction);
    EXPECT_EQ(run.status, 0) << run.output;
    return result("r.json")["standing"]["beyond_grip"].get<double>();
  };
  EXPECT_GT(beyond("0.05"), 0.8);
  EXPECT_EQ(beyond("9"), 0);
}

TEST_F(RaceCommand, TyresSaturateUnlessTheirOptionSaysOtherwise) {
  const auto saturate = [&](const std::string& arguments) {
    const auto run = race("--laps 1 --json r.json " + arguments);
    EXPECT_EQ(run.status, 0) << run.output;
    return result("r.json")["settings"]["options"]["world"]["saturating_tyres"];
  };
  EXPECT_EQ(saturate(""), true);
  EXPECT_EQ(saturate("--set world.saturating_tyres=false"), false);
}

TEST_F(RaceCommand, ComparesTwoRunsAlongTheLap) {
  ASSERT_EQ(race("--laps 2 --json slow.json --set planner.max_speed=2").status, 0);
  const auto run = race("--laps 2 --json fast.json --compare slow.json --plot both.png");
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_TRUE(says(run, "behind slow.json")) << run.output;
  EXPECT_TRUE(fs::exists(folder_ / "both.png"));
  const json fast = result("fast.json"), slow = result("slow.json");
  const double difference = fast["flying"]["best_s"].get<double>() - slow["flying"]["best_s"].get<double>();
  EXPECT_LT(difference, -1);
  EXPECT_NEAR(fast["compared"]["difference_s"].get<double>(), difference, 1e-5);
  const json& behind = fast["along"]["behind_other_s"];
  EXPECT_EQ(behind[0], 0);
  EXPECT_NEAR(behind.back().get<double>(), difference, 1e-5);
  // A run compared with itself is nowhere behind.
  ASSERT_EQ(race("--laps 2 --json again.json --compare fast.json").status, 0);
  const json again = result("again.json");
  for (const json& time : again["along"]["behind_other_s"]) EXPECT_NEAR(time.get<double>(), 0, 1e-4);
}

TEST_F(RaceCommand, SaysWhichRunsCannotBeCompared) {
  ASSERT_EQ(race("--laps 1 --json r.json").status, 0);
  const std::string race_on = "race --config default --set samples=64 --laps 1 ";
  expect_refused(race_on + "--course fox --compare r.json", {"r.json: settings.course", "fox"});
  expect_refused(race_on + "--course wren --start 0.5,0,0 --compare r.json", {"r.json: settings.start"});
  expect_refused(race_on + "--course wren --compare none.json", {"none.json"});
  std::ofstream(folder_ / "text.json") << "lap";
  expect_refused(race_on + "--course wren --compare text.json",
                 {"text.json", "must be a result of slalom race"});
  json damaged = result("r.json");
  damaged["laps"][0]["samples"].erase("speed_mps");
  std::ofstream(folder_ / "damaged.json") << damaged;
  expect_refused(race_on + "--course wren --compare damaged.json",
                 {"damaged.json", "must be a result of slalom race", "speed_mps"});
  expect_refused(race_on + "--course wren --compare r.json --json r.json", {"--compare", "--json", "r.json"});
  const auto other_start = race("--laps 2 --json q.json --compare r.json");
  EXPECT_EQ(other_start.status, 0) << other_start.output;
  EXPECT_TRUE(says(other_start, "r.json has no completed flying lap to compare with")) << other_start.output;
}

TEST_F(RaceCommand, LapsThatAreNotCompletedCount) {
  const auto run = race("--laps 2 --latency-ms 500 --json r.json --plot r.png");
  EXPECT_EQ(run.status, 1) << run.output;
  EXPECT_TRUE(says(run, "standing starts       0 of 2")) << run.output;
  EXPECT_TRUE(says(run, "collision after")) << run.output;
  EXPECT_TRUE(says(run, "no picture, since no lap was completed")) << run.output;
  const json r = result("r.json");
  EXPECT_EQ(r["standing"]["laps"], 2);
  EXPECT_EQ(r["standing"]["completed"], 0);
  EXPECT_TRUE(r["standing"]["mean_s"].is_null());
  EXPECT_TRUE(r["laps"][0]["time_s"].is_null());
  EXPECT_TRUE(r["along"].is_null());
  expect_refused("race --course wren --compare r.json", {"r.json: has no completed lap"});
}

}  // namespace
}  // namespace slalom::tools
