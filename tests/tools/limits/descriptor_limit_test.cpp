// Commands with few open files allowed, from none to enough: the same result or an error that says why, never
// a crash, and never a wait that does not end.
#include "tools/limits/repeatable_results.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using testing::contains;

const std::string wren = "'" SLALOM_COURSES "/wren'";

/// Whether a run begins with the files that one with fewer descriptors has left.
enum class Files { removed, kept };

class DescriptorLimit : public testing::EvaluationFolder {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "undisturbed");
    fs::create_directories(folder_ / "limited");
  }
  testing::Run undisturbed(const std::string& arguments) const {
    return testing::run_program(arguments, (folder_ / "undisturbed").string());
  }
  /// A program that spins is ended after 60 s of the processor, one that waits for ever after 200 s.
  testing::Run limited(const std::string& arguments, int descriptors) const {
    return testing::run_shell("timeout 200 sh -c 'ulimit -n " + std::to_string(descriptors) +
                                  "; ulimit -t 60; exec \"$0\" \"$@\"' '" SLALOM_PROGRAM "' " + arguments,
                              (folder_ / "limited").string());
  }

  /// Runs a command that writes to `out`, each time with more descriptors, until it succeeds: with the files
  /// that it writes undisturbed.
  void succeeds_or_says_why(const std::string& arguments, const std::vector<int>& limits,
                            Files files = Files::removed) const {
    const fs::path expected = folder_ / "undisturbed/out", written = folder_ / "limited/out";
    for (const fs::path& folder : {expected, written}) {
      fs::remove_all(folder);
      fs::create_directories(folder);
    }
    const testing::Run whole = undisturbed(arguments);
    ASSERT_EQ(whole.status, 0) << arguments << ": " << whole.output;
    int errors = 0;
    for (const int descriptors : limits) {
      const std::string what = arguments + ", " + std::to_string(descriptors) + " descriptors";
      const testing::Run run = limited(arguments, descriptors);
      if (run.status == 0) {
        testing::expect_same_files(written, testing::repeatable_files(expected), what);
        EXPECT_GT(errors, 0) << what;
        return;
      }
      ++errors;
      if (run.status == 127) {  // the loader found no descriptor for the first library
        EXPECT_TRUE(contains(run.output, "error while loading shared libraries")) << what << run.output;
      } else {
        EXPECT_EQ(run.status, 1) << what << ": " << run.output;
        EXPECT_TRUE(contains(run.output, "slalom: ")) << what << ": " << run.output;
        EXPECT_TRUE(contains(run.output, "Too many open files")) << what << ": " << run.output;
      }
      if (files == Files::kept) continue;
      fs::remove_all(written);
      fs::create_directories(written);
    }
    ADD_FAILURE() << arguments << ": no limit was enough";
  }

  const std::vector<int> each = {3, 4, 5, 6, 7, 8, 10, 16, 64};
  const std::vector<int> some = {3, 4, 5, 12, 64};  // for commands whose pictures need more, and time
};

TEST_F(DescriptorLimit, DrivesAndRaces) {
  succeeds_or_says_why(
      "drive --course wren --method mppi --set samples=32 --json out/lap.json --record out/lap.mcap", each);
  succeeds_or_says_why(
      "race --course wren --config default --method mppi --set samples=256 --laps 1 --json out/race.json "
      "--plot out/race.png",
      some);
}

/// What a run with too few descriptors has written must not change the result of the next one.
TEST_F(DescriptorLimit, EvaluationsAndSearchesThatAreContinued) {
  succeeds_or_says_why("eval --course " + wren +
                           " --methods mppi --scenario pt --laps 2 --jobs 1 --config default_kinematic --set "
                           "mppi.samples=48 --resume --out out",
                       each, Files::kept);
  succeeds_or_says_why("tune --course " + wren +
                           " --method mppi --scenario pt --jobs 1 --config default_kinematic --set "
                           "temperature=0.5,1 --set samples=32 --budget 2 --laps 1 --rounds 1 --held-out 1 "
                           "--resume --out out",
                       each, Files::kept);
}

TEST_F(DescriptorLimit, Replays) {
  const std::string drive = "drive --course wren --method mppi --set samples=32 --record ../lap";
  ASSERT_EQ(undisturbed(drive + ".mcap").status, 0);
  ASSERT_EQ(undisturbed(drive + ".jsonl").status, 0);
  ASSERT_EQ(undisturbed("eval --course " + wren +
                        " --methods mppi --scenario pt --laps 1 --jobs 1 --config default_kinematic --set "
                        "mppi.samples=48 --out ../laps")
                .status,
            0);
  succeeds_or_says_why("replay ../lap.mcap --html out/lap.html", each);
  succeeds_or_says_why("replay ../laps --lap 0 --record out/lap.jsonl", each);
  succeeds_or_says_why("replay ../laps --lap 0 --plot out/lap.png", some);
}

TEST_F(DescriptorLimit, CoursesAndRooms) {
  succeeds_or_says_why("course '" SLALOM_COURSES "/wren/map.yaml' --out out/course --json out/course.json",
                       some);
  succeeds_or_says_why(
      "navigate --scenario no-way --methods mppi --seeds 1 --json out/rooms.json --table out/rooms.md "
      "--pictures out/pictures",
      some);
}

}  // namespace
}  // namespace slalom::tools
