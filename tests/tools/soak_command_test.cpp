// `slalom soak`: every trial runs, and a failure of any kind is a failure of the whole.
#include <nlohmann/json.hpp>

#include "tools/program_test.hpp"
#include "tools/soak/soak.hpp"

namespace slalom::tools {
namespace {

using nlohmann::json;

/// A soak that is over after one round.
const std::string brief = "soak --hours 0 --course " SLALOM_COURSES
                          "/wren --config default_kinematic --method mppi --set samples=32 ";

class SoakCommand : public testing::ProgramTest {};

TEST_F(SoakCommand, RunsEveryTrialAndPasses) {
  const testing::Run run = program(brief + "--json - 2>words");
  ASSERT_EQ(run.status, 0) << run.output;
  const json result = json::parse(run.output);
  EXPECT_TRUE(result.at("passed"));
  for (const char* trial : {"laps", "sensor_faults", "stalls"})
    EXPECT_EQ(result.at(trial).at("runs"), 1) << trial;
  for (const char* trial : {"laps", "sensor_faults", "stalls", "kills"})
    EXPECT_TRUE(result.at(trial).at("failures").empty()) << trial;
  EXPECT_GE(result.at("spoilt_periods"), 9);
  EXPECT_GT(result.at("ticks"), 100);
  EXPECT_LT(result.at("slowest_return_s"), 0.1);
}

TEST_F(SoakCommand, AnInterruptIsNoSuccessAndLeavesNothing) {
  // In the foreground, since otherwise `timeout` may signal twice, and the second signal ends the program at
  // once.
  const testing::Run run = testing::run_shell(
      "export TMPDIR=$PWD; timeout --foreground --signal=INT 3 '" SLALOM_PROGRAM
      "' soak --hours 1 --course " SLALOM_COURSES
      "/wren --config default_kinematic --method mppi --set samples=32; echo status $?; ls",
      folder_.string());
  EXPECT_NE(run.output.find("interrupted"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("status 124"), std::string::npos) << run.output;
  EXPECT_EQ(run.output.find("slalom-soak"), std::string::npos) << run.output;
}

TEST(SoakResult, FailsOnAnyFailureAndAnyLeak) {
  SoakResult good;
  good.memory_first = good.memory_last = 100 << 20;
  good.descriptors_first = good.descriptors_last = 6;
  EXPECT_TRUE(good.passed());
  for (TrialResult SoakResult::*trial :
       {&SoakResult::laps, &SoakResult::faults, &SoakResult::stalls, &SoakResult::kills}) {
    SoakResult bad = good;
    (bad.*trial).failures.push_back("seed 1: other bits");
    EXPECT_FALSE(bad.passed());
  }
  SoakResult grown = good;
  grown.memory_last += 15 << 20;
  EXPECT_TRUE(grown.passed()) << "allocators keep some memory";
  grown.memory_last += 2 << 20;
  EXPECT_FALSE(grown.passed());
  SoakResult leaked = good;
  ++leaked.descriptors_last;
  EXPECT_FALSE(leaked.passed());
}

}  // namespace
}  // namespace slalom::tools
