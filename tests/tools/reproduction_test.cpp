#include "tools/evaluation/reproduction.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tools/evaluation/paper_program.hpp"

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
  LapLog log;
  log.laps = count;
  for (int i = 0; i < count; ++i) log.ms.push_back(ms * (1 + 0.01 * (i % 7 - 3)));
  return log;
}
LogComparison compared(double measured, const LapLog& log) {
  std::vector<LapRow> rows(30);
  const LapLog ours = laps_of(30, measured);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].state_cost = ours.ms[i];
  return compare_with_log(rows, 0, log);
}

std::string verdict(double measured, double log, double released = 0) {
  Reference r;
  r.log = laps_of(30, log);
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

TEST(Verdict, NoDifferenceInFewLapsIsSaidToBeOne) {
  Reference r;
  r.log = laps_of(3, 1);
  r.published = compared(1, *r.log);
  EXPECT_EQ(verdict_of(r, 0).rfind("agrees with the log: no significant difference, but wide intervals", 0),
            0u)
      << verdict_of(r, 0);
}

}  // namespace
}  // namespace slalom::tools
