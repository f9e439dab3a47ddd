// `slalom tune`: finds what is known to be better, says so on seeds of its own, goes on where it was killed.
#include <sys/file.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tools/evaluation_folder.hpp"

namespace slalom::tools {
namespace {

using testing::contains;
using testing::content;
namespace fs = std::filesystem;
using testing::repeatable;

class TuneCommand : public testing::EvaluationFolder {
 protected:
  /// The start hardly steers: with more variance the car tracks far better.
  static std::string small(const std::string& size = "--budget 24 --rounds 2 --held-out 4") {
    return "tune --course " SLALOM_COURSES
           "/wren --method mppi --scenario pt --set mppi.samples=64 --set variance=0.008:0.5:log "
           "--objective ms --laps 1 --jobs 2 --config timid.yaml " +
           size + " ";
  }
  void SetUp() override {
    EvaluationFolder::SetUp();
    std::ofstream(folder_ / "timid.yaml") << "base: default_kinematic\nmppi:\n  variance: 0.01\n";
  }
  std::string complaint(const std::string& arguments) const {
    const auto r = run(arguments);
    EXPECT_EQ(r.status, 1) << arguments << "\n" << r.output;
    return r.output;
  }
};

TEST_F(TuneCommand, FindsBetterOptionsAndShowsItOnOtherSeeds) {
  const auto r = run(small() + "--out t");
  ASSERT_EQ(r.status, 0) << r.output;
  const auto result = nlohmann::json::parse(content(folder_ / "t/tune.json"));
  EXPECT_GT(std::stod(result.at("best").at("mppi.variance").get<std::string>()), 0.02);
  EXPECT_LT(result.at("held_out").at("objective_best"), result.at("held_out").at("objective_start"));
  EXPECT_LT(result.at("held_out").at("difference_ci").at(1), 0);
  EXPECT_EQ(result.at("held_out").at("laps"), 4);
  int searched = 0;
  for (const auto& step : result.at("steps")) {
    double before = -1e9;
    for (const auto& each : step.at("ranking")) {
      EXPECT_GE(each.at("objective").get<double>(), before) << "best first";
      before = each.at("objective");
    }
    searched = std::max(searched, step.at("ranking").at(0).at("laps").get<int>());
  }
  EXPECT_EQ(searched, 4) << "1, 2 and 4 laps";

  // No seed of the search is among the held-out ones.
  const auto seeds = [&](const std::string& step) {
    std::set<std::string> found;
    std::istringstream lines(content(folder_ / "t" / step / "wren/laps.csv"));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) found.insert(testing::cells(line).at(4));
    return found;
  };
  for (const std::string& seed : seeds("held-out"))
    for (const char* step : {"round1/rung1", "round1/rung2", "round1/rung3", "round2/rung3"})
      EXPECT_EQ(seeds(step).count(seed), 0u) << step << ", " << seed;

  const auto driven = run("eval --course " SLALOM_COURSES
                          "/wren --config t/best.yaml --methods mppi --scenario pt --laps 1 --out e");
  EXPECT_EQ(driven.status, 0) << "the result is a configuration: " << driven.output;
}

TEST_F(TuneCommand, ResumedAfterAKillItFindsTheSame) {
  ASSERT_EQ(run(small() + "--out whole").status, 0);
  int killed = 0;
  for (const int milliseconds : {150, 300, 500, 800}) {
    killed += kill_after(small() + "--resume --out torn", milliseconds);
  }
  EXPECT_GT(killed, 0);
  ASSERT_EQ(run(small() + "--resume --out torn").status, 0);
  EXPECT_EQ(content(folder_ / "torn/best.yaml"), content(folder_ / "whole/best.yaml"));
  EXPECT_EQ(repeatable(folder_ / "torn/held-out/wren/laps.csv"),
            repeatable(folder_ / "whole/held-out/wren/laps.csv"));
}

TEST_F(TuneCommand, RejectsInvalidArguments) {
  const std::string course = "tune --course " SLALOM_COURSES "/wren --out x ";
  EXPECT_TRUE(contains(complaint(course + "--set samples=12"), "a list to search"));
  EXPECT_TRUE(contains(complaint(course + "--set sampels=10:20"), "did you mean svg_mppi.samples"));
  EXPECT_TRUE(contains(complaint(course + "--set samples=20:10"), "lo < hi"));
  EXPECT_TRUE(contains(complaint(course + "--set samples=0:10"), "must be in [1"));
  EXPECT_TRUE(contains(complaint(course + "--set samples=10:20 --objective speed"), "log_ms"));
  EXPECT_TRUE(contains(complaint(course + "--set samples=10:20 --budget 3"), "at least"));
  EXPECT_TRUE(contains(complaint(course + "--set samples=10:20 --scenario po"), "must be pt or oa"));
  EXPECT_TRUE(contains(complaint("tune --course nowhere --out x --set samples=10:20"), "nowhere"));
  EXPECT_FALSE(fs::exists(folder_ / "x"));
}

TEST_F(TuneCommand, AFolderHoldsOneSearch) {
  const std::string tiny = "--held-out 0 --rounds 1 --budget 4";
  ASSERT_EQ(run(small(tiny) + "--out t").status, 0);
  EXPECT_TRUE(contains(complaint(small(tiny) + "--out t"), "--resume"));
  EXPECT_TRUE(contains(complaint(small("--held-out 0 --rounds 1 --budget 5") + "--out t --resume"),
                       "budget: 4 there, 5 here"));
}

TEST_F(TuneCommand, TwoSearchesDoNotShareAFolder) {
  fs::create_directories(folder_ / "t");
  const int other = open((folder_ / "t/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  const std::string tiny = small("--held-out 0 --rounds 1 --budget 4") + "--out t";
  EXPECT_TRUE(contains(complaint(tiny), "t: is in use by"));
  EXPECT_FALSE(fs::exists(folder_ / "t/plan.json"));
  close(other);
  EXPECT_EQ(run(tiny).status, 0);
  EXPECT_FALSE(fs::exists(folder_ / "t/lock"));
}

/// The plan is longer than the largest file that the first run may write.
TEST_F(TuneCommand, APlanThatCannotBeWrittenCompletelyIsNotKept) {
  std::string objective = "ms";
  for (int i = 0; i < 400; ++i) objective += " + log_ms";
  std::string search = small("--held-out 0 --rounds 1 --budget 4") + "--out t";
  const std::string given = "--objective ms";
  search.replace(search.find(given), given.size(), "--objective '" + objective + "'");
  const auto full =
      testing::run_shell("trap '' XFSZ; ulimit -f 2; '" SLALOM_PROGRAM "' " + search, folder_.string());
  EXPECT_EQ(full.status, 1) << full.output;
  EXPECT_TRUE(contains(full.output, "plan.json.new: cannot be written")) << full.output;
  EXPECT_FALSE(fs::exists(folder_ / "t/plan.json"));
  const auto again = run(search);
  EXPECT_EQ(again.status, 0) << again.output;
}

}  // namespace
}  // namespace slalom::tools
