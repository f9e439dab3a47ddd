// Settings of an evaluation that no evaluation has are refused by name; from the others its laps are made
// again.
#include "tools/evaluation/stored_evaluation.hpp"

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"
#include "tools/evaluation/evaluation_job.hpp"
#include "tools/live_view/view_setup.hpp"

namespace slalom::tools {
namespace {

class StoredSettings : public testing::TemporaryFolder {
 protected:
  /// The error message for a folder without laps whose settings have these experiments and this seed.
  std::string complaint(const std::string& experiments, const std::string& seed0 = "0") const {
    write("laps.csv", evaluation::checked_header() + "\n");
    write("settings.json",
          evaluation::with_checksum("{\"experiments\": [" + experiments + "], \"seed0\": " + seed0 + "}"));
    return message_of<IoError>([&] { load_evaluation(folder_); });
  }
  static std::string experiment(const std::string& laps) {
    return R"({"method": "mppi", "set": "", "scenario": "oa", "obstacles": 5, "laps": )" + laps + "}";
  }
};

TEST_F(StoredSettings, NeedAnExperiment) {
  EXPECT_EQ(complaint(experiment("3")), "accepted");
  EXPECT_NE(complaint("").find("settings.json: is invalid: experiments: must be at least one"),
            std::string::npos);
}

TEST_F(StoredSettings, WholeNumbersAreNotCutToFit) {
  EXPECT_NE(complaint(experiment("4294967298")).find("4294967298"), std::string::npos);
  EXPECT_NE(complaint(experiment("0")).find("laps: 0 must be in [1, 1000000]"), std::string::npos);
  EXPECT_NE(complaint(experiment("3"), "1e30").find("must be a whole number"), std::string::npos);
}

TEST_F(StoredSettings, TheLiveViewShowsALapInTheWorldOfItsExperiment) {
  EvaluationArguments arguments;
  arguments.scenario.course = SLALOM_COURSES "/wren";
  arguments.scenario.config = SLALOM_CONFIGS "/default_kinematic.yaml";
  const auto experiments = make_experiments(
      {"mppi"}, {"pt"}, 2, 0,
      {"world.opponents=2", "world.planning_opponents=1", "world.friction=0.7", "mppi.samples=48"});
  const Scenario scenario = load_scenario(arguments.scenario, "mppi");
  write("laps.csv", evaluation::checked_header(experiments) + "\n");
  write("settings.json",
        evaluation::with_checksum(make_evaluation(arguments, scenario, experiments).settings));
  view::SessionOptions options;
  open_evaluation(folder_.string(), options);
  const view::LoadedLap lap = options.load_lap(0, 1);
  EXPECT_EQ(lap.names.opponents, 2);
  EXPECT_EQ(lap.scenario.lap.opponents, 2);
  EXPECT_EQ(lap.scenario.lap.planning_opponents, 1);
  EXPECT_EQ(lap.scenario.lap.friction, 0.7);
  ASSERT_TRUE(lap.scenario.lap.opponent_planner);
  EXPECT_EQ(vehicle::to_yaml(lap.scenario.lap.opponent_planner->configuration),
            vehicle::to_yaml(scenario.configuration))
      << "without the options of the experiment";
  EXPECT_NE(vehicle::to_yaml(lap.scenario.configuration), vehicle::to_yaml(scenario.configuration));
}

}  // namespace
}  // namespace slalom::tools
