// Results of few laps against values computed by hand.
#include "slalom/evaluation/results.hpp"

#include "slalom/core/error.hpp"
#include "slalom/evaluation/lap_log.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::evaluation::results_test {
namespace {

LapRow row(int experiment, int lap, double state, double collision_cost, int contacts, bool finished) {
  LapRow r;
  r.experiment = experiment;
  r.lap = lap;
  r.state_cost = state;
  r.collision_cost = collision_cost;
  r.collisions = contacts;
  r.finished = finished;
  r.timeout = !finished;
  r.success = finished && contacts == 0;
  r.time = finished ? 10 + lap : 50;
  r.solve_mean = 1 + lap;
  r.solve_max = 5 + lap;
  return r;
}

const std::vector<Experiment> experiments{
    {"mppi", {}, "oa", 5, 4}, {"svg_mppi", {}, "oa", 5, 4}, {"mppi", {}, "pt", 0, 1}};

std::vector<LapRow> laps() {
  return {row(0, 0, 1, 2, 0, true),   row(0, 1, 1, 4, 2, true),   row(0, 2, 2, 20, 6, false),
          row(0, 3, 0.5, 0, 0, true), row(1, 3, 0.5, 0, 0, true), row(1, 2, 1, 0, 1, true),
          row(1, 1, 1, 0, 0, true),   row(1, 0, 1, 1, 0, true),   row(2, 0, 0.25, 0, 0, true)};
}

TEST(Results, EveryLapCountsWhetherItFinishedOrNot) {
  const auto results = summarise(laps(), experiments);
  ASSERT_EQ(results.size(), 3u);
  const ExperimentResult& r = results[0];
  EXPECT_EQ(std::tuple(r.laps, r.finished, r.timeouts, r.collisions), std::tuple(4, 3, 1, 8));
  EXPECT_DOUBLE_EQ(r.ms_mean, (3 + 5 + 22 + 0.5) / 4);
  EXPECT_DOUBLE_EQ(r.state_cost_mean, 4.5 / 4);
  EXPECT_DOUBLE_EQ(r.collision_cost_mean, 26.0 / 4);
  EXPECT_LT(r.ms_ci.low, r.ms_mean);
  EXPECT_GT(r.ms_ci.high, r.ms_mean);
  EXPECT_DOUBLE_EQ(*r.collision_rate, 8.0 / 20);
  EXPECT_DOUBLE_EQ(r.collision_rate_ci->low, wilson_interval(8, 20).low);
  EXPECT_DOUBLE_EQ(r.success_rate, 0.5);
  EXPECT_DOUBLE_EQ(r.time_mean, (10 + 11 + 13) / 3.0) << "of finished laps";
  EXPECT_EQ(r.time_ci.low, 10);
  EXPECT_EQ(r.time_ci.high, 13);
  EXPECT_DOUBLE_EQ(r.solve_mean, 2.5);
  EXPECT_DOUBLE_EQ(r.solve_max, 8);
}

TEST(Results, TheTimeToOvertakeIsTheMeanOverAllOpponentsOvertaken) {
  const std::vector<Experiment> with{{"mppi", {{"world.opponents", "3"}}, "pt", 0, 3}};
  std::vector<LapRow> rows{row(0, 0, 1, 0, 0, true), row(0, 1, 1, 0, 0, true), row(0, 2, 1, 0, 0, true)};
  rows[0].overtaking = {4, 3, 1, 2, 2, 1, 5};
  rows[1].overtaking = {2, 1, 0, 10, 3, 2, 1};
  rows[2].overtaking = {1, 0, 1, 0, 0, 0, 2};
  const auto results = summarise(rows, with);
  ASSERT_TRUE(results[0].overtaking);
  const auto& f = *results[0].overtaking;
  EXPECT_EQ(std::tuple(f.met, f.overtaken, f.not_overtaken, f.contacts, f.caused, f.side_changes),
            std::tuple(7, 4, 2, 5, 3, 8));
  EXPECT_DOUBLE_EQ(f.duration, (3 * 2.0 + 10) / 4);
  EXPECT_FALSE(summarise(laps(), experiments)[0].overtaking) << "without opponents";
}

TEST(Results, WithoutObstaclesThereIsNoCollisionRate) {
  const auto results = summarise(laps(), experiments);
  EXPECT_FALSE(results[2].collision_rate);
  EXPECT_FALSE(results[2].collision_rate_ci);
  EXPECT_EQ(results[2].collisions, 0);
}

TEST(Results, PairsAreLapsOfTheSameScenario) {
  const auto pairs = compare_pairs(laps(), experiments);
  ASSERT_EQ(pairs.size(), 1u);
  const PairedComparison& c = pairs[0];
  EXPECT_EQ(c.laps, 4);
  EXPECT_DOUBLE_EQ(c.ms_difference, ((3 - 2) + (5 - 1) + (22 - 1) + 0) / 4.0);
  EXPECT_EQ(c.only_a_succeeds, 0);
  EXPECT_EQ(c.only_b_succeeds, 1);
  EXPECT_DOUBLE_EQ(c.success_p, 1);
  EXPECT_DOUBLE_EQ(*c.ms_p, 0.25) << "three differences of one sign: 2 / 2^3";
  EXPECT_DOUBLE_EQ(c.time_difference, 0) << "of the laps that both finish";
}

TEST(Results, LapTimesAreTestedInPairs) {
  std::vector<LapRow> rows;
  for (int lap = 0; lap < 8; ++lap)
    for (const int experiment : {0, 1}) {
      rows.push_back(row(experiment, lap, 1, 0, 0, true));
      rows.back().time = 20 + 3 * lap + 0.01 * (lap + 1) * experiment;
    }
  const auto a = rows_of(rows, 0), b = rows_of(rows, 1);
  const Comparison paired = compare_laps(a, 40, b, 40, true), unpaired = compare_laps(a, 40, b, 40, false);
  EXPECT_DOUBLE_EQ(paired.time_p, 2 / 256.0) << "eight differences of one sign";
  EXPECT_NEAR(paired.time_difference, -0.045, 1e-12);
  EXPECT_NEAR(unpaired.time_difference, -0.045, 1e-12);
  EXPECT_GT(unpaired.time_p, 0.5) << "lost in the scatter of the laps";
  EXPECT_EQ(unpaired.success_p, 1);
}

TEST(Fisher, KnownValues) {
  EXPECT_NEAR(fisher_p(16, 210, 5, 100), 0.47481298187393234, 1e-9);
  EXPECT_NEAR(fisher_p(3, 10, 8, 10), 0.06977851869492735, 1e-9);
  EXPECT_NEAR(fisher_p(20, 500, 16, 210), 0.05939479840417984, 1e-9);
  EXPECT_DOUBLE_EQ(fisher_p(0, 10, 0, 20), 1);
  EXPECT_DOUBLE_EQ(fisher_p(3, 0, 1, 5), 1);
  EXPECT_DOUBLE_EQ(fisher_p(12, 10, 10, 10), 1) << "more than all count as all";
}

/// A log of laps in a file that goes with the test.
class LapLogFile : public testing::TemporaryFolder {
 protected:
  LapLog read(const std::string& text) const { return read_lap_log(write("log.csv", text)); }
  /// Expects that this text is refused in these words.
  void refuses(const std::string& text, const char* words) const {
    expect_error_with<IoError>({words}, [&] { read(text); });
  }
};

TEST_F(LapLogFile, IsReadByColumnName) {
  const LapLog log = read(
      "seed,success,collision,timeout,state_cost,collision_cost,mean_calculation_time,max_calculation_time\n"
      "0,1,0,0,0.5,1.5,10,20\r\n10,0,2,1,1,4,12,18\n");
  EXPECT_EQ(std::tuple(log.laps, log.successes, log.timeouts, log.collisions), std::tuple(2, 1, 1, 2));
  EXPECT_EQ(log.ms, (std::vector<double>{2, 5}));
  EXPECT_DOUBLE_EQ(*log.solve_ms_mean, 11);
  EXPECT_DOUBLE_EQ(*log.solve_ms_max, 20);
  EXPECT_FALSE(read("collision_cost,state_cost,success,collision\n0,1,1,0\n").solve_ms_mean);
}

TEST_F(LapLogFile, ErrorsNameLineAndColumn) {
  refuses("", "is empty");
  refuses("success,collision,state_cost\n", "column collision_cost is missing");
  refuses("success,success,collision,state_cost,collision_cost\n1,0,1,2\n",
          "log.csv:1: column 'success' is given twice");
  const std::string head = "success,collision,state_cost,collision_cost\n";
  refuses(head, "contains no lap");
  refuses(head + "1,0,1\n", ":2: has 3 columns");
  refuses(head + "1,0,nan,0\n", ":2: state_cost");
  refuses(head + "1,0.5,1,0\n", ":2: collision");
  refuses(head + "2,0,1,0\n", ":2: success");
  refuses(head + "1,0,1e308,1e308\n", ":2: state_cost: '1e308' must be at most 1e12");
  refuses(head + std::string(65537, ',') + "\n", ":2: is longer than 65536 bytes");
  std::string laps = head;
  for (int lap = 0; lap <= 1000000; ++lap) laps += "1,0,1,1\n";
  refuses(laps, "has more than 1000000 laps");
  const auto file = write("log.csv", head);
  std::filesystem::resize_file(file, (std::uintmax_t{1} << 26) + 1);
  EXPECT_THROW(read_lap_log(file), IoError);
}

TEST_F(LapLogFile, IsComparedWithLaps) {
  const LapLog log =
      read("success,collision,state_cost,collision_cost\n1,0,1,2\n1,0,1,4\n0,6,2,20\n1,2,0.5,0\n");
  std::vector<LapRow> ours = laps();
  ours.resize(4);
  const LogComparison same = compare_with_log(ours, 5, log);
  EXPECT_DOUBLE_EQ(same.ms_ratio, 1);
  EXPECT_DOUBLE_EQ(same.ms_p, 1);
  EXPECT_NEAR(*same.collision_p, 1, 1e-9);
  EXPECT_EQ(same.agreement(), Agreement::undecided) << "equal, but 4 laps say little";
  for (LapRow& lap : ours) {
    lap.state_cost = 100 + lap.lap;
    lap.collisions = 5;
  }
  const LogComparison other = compare_with_log(ours, 5, log);
  EXPECT_EQ(other.ms_agreement(), Agreement::outside);
  EXPECT_EQ(other.collision_agreement(), Agreement::outside);
  EXPECT_DOUBLE_EQ(*other.collision_rate, 8.0 / 20);
}

TEST_F(LapLogFile, LapsWithTheSameSeedsArePaired) {
  std::string text = "seed,success,collision,state_cost,collision_cost\n";
  for (int lap = 0; lap < 100; ++lap)
    text +=
        std::to_string(10 * lap) + ",1," + std::to_string(lap % 2) + "," + std::to_string(1 + lap) + ",0\n";
  const LapLog log = read(text);
  const auto drive = [&](int laps, double more, std::uint64_t seed0) {
    std::vector<LapRow> ours(static_cast<std::size_t>(laps));
    for (std::size_t lap = 0; lap < ours.size(); ++lap) {
      ours[lap].seed = seed0 + 10 * lap;
      ours[lap].state_cost = 1 + more + static_cast<double>(lap);
      ours[lap].collisions = static_cast<int>(lap % 2);
    }
    return compare_with_log(ours, 5, log);
  };
  const LogComparison two = drive(2, 0, 0);  // the laps of the log with these seeds have the same figures
  EXPECT_TRUE(two.paired);
  EXPECT_EQ(two.laps, 2);
  EXPECT_DOUBLE_EQ(two.ms_ratio, 1);
  EXPECT_DOUBLE_EQ(two.ms_p, 1);
  EXPECT_DOUBLE_EQ(*two.collision_p, 1);
  EXPECT_DOUBLE_EQ(two.ms_mean, 50.5) << "the figure of the whole log";
  EXPECT_NE(two.agreement(), Agreement::outside);
  EXPECT_LT(drive(30, 0.1, 0).ms_p, 0.001) << "lost in the scatter unless the laps are paired";
  EXPECT_FALSE(drive(2, 0, 5).paired);
}

TEST_F(LapLogFile, AgreementDependsOnDifferenceAndNumberOfLaps) {
  std::string text = "success,collision,state_cost,collision_cost\n";
  for (int lap = 0; lap < 30; ++lap) text += "1,0," + std::to_string(2.5 + 0.03 * lap) + ",0\n";
  const LapLog log = read(text);
  std::vector<LapRow> ours;
  const auto drive = [&](int laps, double ms, double step) {
    ours.assign(static_cast<std::size_t>(laps), {});
    for (int lap = 0; lap < laps; ++lap) ours[static_cast<std::size_t>(lap)].state_cost = ms + step * lap;
    return compare_with_log(ours, 0, log);
  };
  const LogComparison far = drive(3, 12, 2);
  EXPECT_LT(far.ms_p, 0.01) << "14 beside 2.9 is no draw of the same, however few the laps";
  EXPECT_EQ(far.agreement(), Agreement::outside);
  EXPECT_EQ(drive(3, 2.8, 0.2).agreement(), Agreement::undecided);
  const LogComparison many = drive(30, 2.53, 0.03);
  EXPECT_EQ(many.agreement(), Agreement::inside);
  EXPECT_LT(many.ms_ratio_ci.low, 1.01);
  EXPECT_GT(many.ms_ratio_ci.high, 1.01);
  EXPECT_EQ(drive(12, -10, 2.355).agreement(), Agreement::undecided)
      << "nearly the same mean, far too scattered";
}

}  // namespace
}  // namespace slalom::evaluation::results_test
