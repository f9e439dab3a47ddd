#include "tools/evaluation/reproduction.hpp"

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "slalom/core/error.hpp"
#include "slalom/vehicle/course/course.hpp"
#include "support/temporary_folder.hpp"
#include "tools/evaluation/claims.hpp"
#include "tools/paper_clone.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;

/// The authors' steer_cov is the variance of the samples and of the guides' prior in one.
TEST(PaperRows, AFixedCovarianceSetsBothVariances) {
  int fixed = 0;
  for (const PaperRow& row : paper_rows()) {
    const std::map<std::string, std::string> set(row.set.begin(), row.set.end());
    if (!set.count("svg_mppi.variance")) continue;
    EXPECT_EQ(set.at("svg_mppi.adapt_covariance"), "false") << row.name;
    ASSERT_TRUE(set.count("svg_mppi.guide_variance")) << row.name;
    EXPECT_EQ(set.at("svg_mppi.variance"), set.at("svg_mppi.guide_variance")) << row.name;
    ++fixed;
  }
  EXPECT_EQ(fixed, 11);
}

class PaperClone : public testing::TemporaryFolder {
 protected:
  PaperClone() { testing::write_paper_clone(folder_, SLALOM_COURSES "/wren"); }
};

TEST_F(PaperClone, HasCoursesAndLogsUnderTheirNames) {
  for (const char* course : {"berlin", "spielberg"}) {
    const PaperFiles files = find_paper_files(folder_, course);
    EXPECT_EQ(files.course, folder_ / "data/map" / course);
    EXPECT_EQ(files.logs.empty(), std::string(course) != "berlin") << "the logs are of Berlin";
    ASSERT_GE(files.notes.size(), 2u);
    EXPECT_EQ(files.notes[1].rfind("36 of 36 logs", 0), 0u) << files.notes[1];
    const auto loaded = vehicle::load_course(files.course);
    EXPECT_EQ(loaded.name, course);
    EXPECT_GT(loaded.waypoints.size(), 10u);
    EXPECT_NE(loaded.obstacle_path.size(), loaded.waypoints.size()) << "opp_ref_path.csv is read";
  }
  const auto experiments = paper_experiments({"table1", "table2", "covariances"}, 2, 2, 5);
  for (const Reference& r : find_references(folder_ / "src/eval/log", experiments, {}))
    EXPECT_TRUE(r.log) << r.verdict;
}

TEST_F(PaperClone, SaysWhatIsMissing) {
  std::filesystem::remove(folder_ / "src/eval/log/path_tracking/forward_mppi(cov:0.025).csv");
  const PaperFiles files = find_paper_files(folder_, "berlin");
  EXPECT_NE(files.notes.at(1).find("35 of 36 logs"), std::string::npos) << files.notes[1];
  EXPECT_NE(files.notes[1].find("missing: path_tracking/forward_mppi(cov:0.025).csv"), std::string::npos);
  std::filesystem::remove_all(folder_ / "src");
  EXPECT_TRUE(find_paper_files(folder_, "berlin").logs.empty());
  EXPECT_THROW(find_paper_files(folder_ / "data", "berlin"), IoError) << "not a clone";
  EXPECT_TRUE(find_paper_files("", "stag").course.empty());
}

/// The authors' repository, if it is beside the other data.
TEST(AuthorsData, IsReadAndItsClaimsAreTested) {
  const char* data = std::getenv("SLALOM_DATA_DIR");
  const std::filesystem::path clone = std::filesystem::path(data ? data : "") / "../proj-svg_mppi";
  if (!data || !std::filesystem::exists(clone)) GTEST_SKIP() << "no clone of the authors' repository";
  for (const char* course : {"berlin", "spielberg"})
    EXPECT_GT(vehicle::load_course(find_paper_files(clone, course).course).obstacle_path.size(), 100u);
  const PaperFiles files = find_paper_files(clone, "berlin");
  EXPECT_EQ(files.notes.at(1).rfind("36 of 36 logs", 0), 0u) << files.notes[1];
  std::map<std::string, std::string> verdicts;
  for (const auto& claim : claims_json(files.logs, {}, {})) {
    ASSERT_FALSE(claim["logs"].is_null()) << claim["claim"];
    EXPECT_TRUE(claim["slalom"].is_null());
    verdicts[claim["claim"].get<std::string>()] = claim["logs"]["verdict"].get<std::string>();
  }
  EXPECT_EQ(verdicts.at("SVG-MPPI is superior among obstacles (to SV-MPC)"), "holds");
  EXPECT_EQ(verdicts.at("SVG-MPPI has the lowest collision rate (against NS)"), "reversed");
  EXPECT_EQ(verdicts.at("AC is better than NS among obstacles"), "reversed");
}

TEST(Claim, IsTestedOnLapsWithTheSameSeeds) {
  LapLog better, worse;
  for (int lap = 0; lap < 20; ++lap) {
    better.seeds.push_back(10 * lap);
    better.ms.push_back(1 + 0.1 * lap);
    better.lap_collisions.push_back(0);
  }
  worse = better;
  for (double& ms : worse.ms) ms += 0.01;  // lost in the scatter of the laps unless they are paired
  worse.seeds[0] = 1000;
  const Claim claim{"", "", "", "oa"}, collisions{"", "", "", "oa", true};
  EXPECT_EQ(test_claim(claim, better, worse)->laps, 19);
  EXPECT_STREQ(test_claim(claim, better, worse)->verdict(), "holds");
  EXPECT_STREQ(test_claim(claim, worse, better)->verdict(), "reversed");
  EXPECT_STREQ(test_claim(collisions, better, worse)->verdict(), "not shown");
  worse.seeds.assign(20, 1000);
  EXPECT_FALSE(test_claim(claim, better, worse)) << "no lap with the same seed";
}

TEST(PaperRows, NameTheLapsOfTheReleasedProgram) {
  std::set<std::string> rows;
  for (const PaperRow& row : paper_rows()) rows.insert(row.released);
  EXPECT_FALSE(rows.count("")) << "every row has a name";
  int driven = 0;
  for (const std::string& row : rows)
    for (const char* scenario : {"pt", "oa"}) {
      const auto laps = paper_program_laps(row, scenario);
      if (!laps) continue;
      ++driven;
      EXPECT_EQ(laps->laps, static_cast<int>(laps->ms.size()));
      EXPECT_GT(laps->laps, 0);
    }
  EXPECT_GE(driven, 10);
  EXPECT_FALSE(paper_program_laps("svg_mppi", "other"));
}

/// Laps whose MS scatter round `ms`.
LapLog laps_of(int count, double ms) {
  LapLog log{.laps = count};
  for (int i = 0; i < count; ++i) log.ms.push_back(ms * (1 + 0.01 * (i % 7 - 3)));
  return log;
}
LogComparison compared(double measured, const LapLog& log, int count = 30) {
  std::vector<LapRow> rows(static_cast<std::size_t>(count));
  const LapLog ours = laps_of(count, measured);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].state_cost = ours.ms[i];
  return compare_with_log(rows, 0, log);
}

std::string verdict(double measured, double log, double released = 0) {
  Reference r{.log = laps_of(30, log)};
  r.published = compared(measured, *r.log);
  if (released > 0) {
    r.released_log = laps_of(8, released);
    r.released = compared(measured, *r.released_log);
  }
  return verdict_of(r, 0);
}

TEST(Verdict, SaysWithWhichOfTheTwoTheLapsAgree) {
  EXPECT_EQ(verdict(1, 1, 2), verdicts::log);
  EXPECT_EQ(verdict(1, 2, 1).rfind(
                "agrees with the paper's program, not with the log: MS 0.996 in 8 laps, p = ", 0),
            0u)
      << verdict(1, 2, 1);
  EXPECT_NE(verdict(1, 2, 1).find("log: MS 50.0 % lower (p < 0.001)"), std::string::npos) << verdict(1, 2, 1);
  EXPECT_EQ(verdict(1, 2, 3).rfind("disagrees with both: log: MS 50.0 % lower", 0), 0u) << verdict(1, 2, 3);
  EXPECT_EQ(verdict(1, 2).rfind("disagrees with the log: MS 50.0 % lower", 0), 0u) << verdict(1, 2);
  EXPECT_EQ(verdict_of({}, 0), verdicts::none);
}

TEST(Verdict, FewLapsDecideNothing) {
  Reference r{.log = laps_of(3, 1)};
  r.published = compared(1, *r.log);
  EXPECT_EQ(verdict_of(r, 0).rfind("too few laps to decide: MS", 0), 0u) << verdict_of(r, 0);
}

TEST(Verdict, LapsOfTheProgramThatCannotDifferDecideNothing) {
  Reference r{.log = laps_of(30, 2)};
  r.published = compared(1, *r.log, 3);
  for (const auto& [count, decides] : {std::pair(1, false), {3, false}, {4, true}}) {
    r.released_log = laps_of(count, 1);
    r.released = compared(1, *r.released_log, 3);
    const std::string text = verdict_of(r, 0);
    EXPECT_EQ(text.rfind(decides ? verdicts::released : verdicts::undecided, 0), 0u) << text;
  }
}

}  // namespace
}  // namespace slalom::tools
