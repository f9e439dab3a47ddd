// `slalom identify` finds the servo and the tyres of a simulated car, and `slalom bench` measures models with
// two inputs.
#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

class BenchCommand : public testing::ProgramTest {};

TEST_F(BenchCommand, MeasuresModelsWithTwoInputs) {
  for (const std::string config : {"default", "default_speed"}) {
    succeed("bench --config " + config +
            " --methods svg_mppi --set svg_mppi.samples=256 --seconds 0.01 --json b.json");
    const json told = result("b.json");
    EXPECT_GT(told["rollout_ns_per_step"], 0) << config;
    EXPECT_GT(told["methods"]["svg_mppi"]["solve_ms"]["p50"], 0) << config;
    EXPECT_GT(told["tick_ms"], told["tick"]["without_solve_ms"]["p50"]) << config;
    EXPECT_FALSE(told.contains("rollout_gflops")) << "only the operations of the fixed workload are known";
    ASSERT_EQ(told["vehicle_models"].size(), 4u);
    EXPECT_EQ(told["vehicle_models"][0]["times_the_first"], 1);
    EXPECT_EQ(told["vehicle_models"][3]["model"], "single_track, saturating tyres");
    EXPECT_GT(told["vehicle_models"][3]["rollout_ns_per_step"], 0);
  }
}

class IdentifyCommand : public testing::ProgramTest {};

TEST_F(IdentifyCommand, FindsTheServoOfASimulatedCar) {
  succeed(
      "drive --course eel --config default_kinematic --method mppi --set samples=128 --hardware "
      "--record lap.mcap");
  succeed("identify lap.mcap --wheelbase 0.3302 --json found.json");
  const json found = result("found.json");
  EXPECT_NEAR(found["steering_gain"]["value"], 0.95, 0.05);
  EXPECT_NEAR(found["steering_offset"]["value"], 0.01, 0.004);
  EXPECT_NEAR(found["time_constant"]["value"], 0.07, 0.025);
  EXPECT_NEAR(found["delay"]["value"], 0.045, 0.015);
  EXPECT_GT(found["explained"], 0.9);
  EXPECT_EQ(found["wheelbase"]["deviation"], 0);

  const std::string free = succeed("identify lap.mcap --json free.json");
  testing::expect_says(free, {"determines only the ratio of gain and wheelbase"});
  EXPECT_FALSE(contains(free, "front_length")) << free;
  const json sought = result("free.json");
  const double ratio =
      sought["steering_gain"]["value"].get<double>() / sought["wheelbase"]["value"].get<double>();
  EXPECT_NEAR(ratio, 0.95 / 0.3302, 0.15);
}

TEST_F(IdentifyCommand, FindsTheFrictionOfASimulatedCarWhoseTyresSlip) {
  succeed(
      "drive --course fox --set samples=256 --set world.saturating_tyres=true --set world.friction=0.6 "
      "--laps 2 --record lap.mcap");
  const std::string said = succeed("identify lap.mcap --tyres --config default --json found.json");
  const json found = result("found.json");
  EXPECT_NEAR(found["friction"]["value"], 0.6, 0.06);
  EXPECT_NEAR(found["cornering_front"]["value"], 4.718, 0.9);
  EXPECT_NEAR(found["cornering_rear"]["value"], 5.4562, 1.1);
  EXPECT_NEAR(found["steering_gain"]["value"], 1, 0.08);
  EXPECT_NEAR(found["delay"]["value"], 0.02, 0.01);
  testing::expect_says(said, {"  friction: "});
  expect_refused("identify lap.mcap --config default", {"--config", "--tyres"});
  expect_refused("identify lap.mcap --tyres --wheelbase 0.33", {"--wheelbase", "--tyres"});
  expect_refused("identify lap.mcap --tyres --config nothing", {"nothing", "known: "});
}

TEST_F(IdentifyCommand, RejectsInvalidInput) {
  expect_refused("identify nothing.mcap", {"nothing.mcap", "cannot be read"});
  expect_refused("identify .", {".: is a folder without files of rosbag2"});
  std::ofstream(folder_ / "a.mcap") << "\x89MCAP0\r\n";
  expect_refused("identify a.mcap", {"a.mcap: the bag has no poses"});
  std::ofstream(folder_ / "empty.csv") << "time,x,y\n";
  expect_refused("identify empty.csv", {"empty.csv: is neither a recording in MCAP nor a bag of rosbag2"});
}

}  // namespace
}  // namespace slalom::tools
