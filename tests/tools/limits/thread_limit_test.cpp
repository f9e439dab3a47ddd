// Commands when the system starts fewer threads than they ask for: the same result with fewer threads, which
// they report, or an error that says how many could start.
#include "tools/limits/repeatable_results.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using testing::contains;

class ThreadLimit : public testing::EvaluationFolder {
 protected:
  void SetUp() override {
    for (const char* name : {"undisturbed", "limited"}) fs::create_directories(folder_ / name / "out");
  }
  testing::Run undisturbed(const std::string& arguments) const {
    return testing::run_program(arguments, (folder_ / "undisturbed").string());
  }
  /// The program can start only so many threads besides its first.
  testing::Run limited(const std::string& arguments, int starts) const {
    return testing::run_shell("SLALOM_TESTS_THREAD_STARTS=" + std::to_string(starts) +
                                  " LD_PRELOAD='" SLALOM_FEW_THREADS "' timeout 200 '" SLALOM_PROGRAM "' " +
                                  arguments,
                              (folder_ / "limited").string());
  }
  /// A command with `option` 3 does the same work with fewer threads, and says how many there were.
  void works_with_fewer(const std::string& arguments, const std::string& option) const {
    const std::string command = arguments + " " + option + " 3";
    const testing::Run whole = undisturbed(command);
    EXPECT_FALSE(contains(whole.output, "the system could start")) << whole.output;
    const auto expected = testing::repeatable_files(folder_ / "undisturbed/out");
    ASSERT_FALSE(expected.empty()) << command << ": " << whole.output;
    for (int starts = 0; starts < 2; ++starts) {
      fs::remove_all(folder_ / "limited/out");
      fs::create_directories(folder_ / "limited/out");
      const testing::Run run = limited(command, starts);
      EXPECT_EQ(run.status, whole.status) << command << ": " << run.output;
      EXPECT_TRUE(contains(run.output, option + " 3: the system could start " +
                                           (starts == 0 ? "1 thread only" : "2 threads only")))
          << command << ": " << run.output;
      testing::expect_same_files(folder_ / "limited/out", expected, command);
    }
  }
  /// The command ends with an error that has these words.
  void refuses(const std::string& arguments, int starts, const std::string& words) const {
    const testing::Run run = limited(arguments, starts);
    EXPECT_EQ(run.status, 1) << arguments << ", " << starts << ": " << run.output;
    EXPECT_TRUE(contains(run.output, "slalom: " + words))
        << arguments << ", " << starts << ": " << run.output;
  }
};

TEST_F(ThreadLimit, EvaluationsShareTheirLaps) {
  works_with_fewer("eval --course '" SLALOM_COURSES
                   "/wren' --methods mppi --scenario pt --laps 3 --config default_kinematic --set "
                   "mppi.samples=48 --out out/laps",
                   "--jobs");
}

TEST_F(ThreadLimit, SearchesShareTheirLaps) {
  works_with_fewer("tune --course '" SLALOM_COURSES
                   "/wren' --method mppi --scenario pt --config default_kinematic --set temperature=0.5,1 "
                   "--set samples=32 --budget 2 --laps 1 --rounds 1 --held-out 1 --out out/search",
                   "--jobs");
}

TEST_F(ThreadLimit, LapsUnderTheConditionsOfACarAreShared) {
  works_with_fewer(
      "hardware --drivers mppi@default_kinematic --set samples=64 --tracking-laps 1 --layouts 1 --laps 1 "
      "--obstacles 2 --json out/laps.json",
      "--jobs");
}

TEST_F(ThreadLimit, RacesAreShared) {
  works_with_fewer(
      "race --course wren --config default_kinematic --method mppi --set samples=64 --laps 1 --cars 2 "
      "--races 3 --json out/races.json",
      "--jobs");
}

TEST_F(ThreadLimit, DrivesThroughRoomsAreShared) {
  works_with_fewer("navigate --scenario no-way --methods mppi,svg_mppi --seeds 1 --json out/rooms.json",
                   "--threads");
}

TEST_F(ThreadLimit, ADriveWithoutTheThreadsOfItsSolverIsAnError) {
  const std::string drive =
      "drive --course wren --method mppi --set samples=32 --json out/lap.json --threads 3";
  ASSERT_EQ(undisturbed(drive).status, 0);
  const std::string race = "race --course wren --method mppi --set samples=32 --laps 1 --threads 3";
  for (int starts = 0; starts < 2; ++starts) {
    const std::string words = "threads: 3 cannot start, " + std::to_string(starts + 1) + " can";
    refuses(drive, starts, words);
    refuses(race, starts, words);
    refuses(race + " --cars 2", starts, words);
    EXPECT_FALSE(fs::exists(folder_ / "limited/out/lap.json"));
  }
  // The options are checked with a solver whose threads then end; that of the lap needs as many.
  int starts = 2;
  testing::Run run = limited(drive, starts);
  for (; run.status != 0 && starts < 12; run = limited(drive, ++starts))
    EXPECT_TRUE(contains(run.output, "slalom: threads: 3 cannot start")) << starts << ": " << run.output;
  EXPECT_EQ(run.status, 0) << starts << ": " << run.output;
  testing::expect_same_files(folder_ / "limited/out", testing::repeatable_files(folder_ / "undisturbed/out"),
                             drive);
}

TEST_F(ThreadLimit, APageWithoutTheThreadOfItsServerIsAnError) {
  const std::string no_server = "the system cannot start the thread of the server";
  refuses("view --port 0 --threads 3", 0, no_server);
  for (int solver = 0; solver < 2; ++solver)
    refuses("view --port 0 --threads 3", 1 + solver,
            "threads: 3 cannot start, " + std::to_string(solver + 1) + " can");
  const std::string record = "drive --course wren --method mppi --set samples=32 --record ../lap.mcap";
  ASSERT_EQ(undisturbed(record).status, 0);
  refuses("replay ../lap.mcap --port 0", 0, no_server);
}

}  // namespace
}  // namespace slalom::tools
