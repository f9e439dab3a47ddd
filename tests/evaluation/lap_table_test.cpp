// laps.csv reads back to the same bits; errors name line and column.
#include "slalom/evaluation/lap_table.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "slalom/core/error.hpp"
#include "slalom/evaluation/evaluation.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::evaluation {
namespace {

namespace fs = std::filesystem;

const std::vector<Experiment> experiments{
    {"mppi", {}, "pt", 0, 3},
    {"svg_mppi", {{"svg_mppi.variance", "0.075"}, {"vehicle.dead_time", "0"}}, "oa", 5, 2}};

LapRow row(int experiment, int lap) {
  LapRow r;
  r.experiment = experiment;
  r.lap = lap;
  r.seed = lap_seed(0, lap, experiment == 0 ? 0 : 5);
  r.success = true;
  r.collisions = 3;
  r.finished = true;
  r.state_cost = 0.1 + 0.2;
  r.collision_cost = 1e-300;
  r.impassable = 2;
  r.time = 1.0 / 3;
  r.min_clearance = -0.0125;
  r.contact_points = "1.250:-3.000 0.500:2.125";
  r.solve_p99 = 12.5;
  return r;
}

TEST(LapTableColumns, IncludeThoseOfTheTrackerIfAnExperimentUsesOne) {
  std::vector<Experiment> tracking = experiments;
  tracking[1].set.emplace_back("world.tracking", "off");
  EXPECT_FALSE(tracking[1].tracks());
  EXPECT_EQ(csv_header(tracking), csv_header());
  tracking[1].set.back().second = "exact";
  EXPECT_TRUE(tracking[1].tracks());
  EXPECT_EQ(csv_header(tracking).rfind(csv_header() + ",tracking_in_view,", 0), 0U);
  LapRow r = row(1, 0);
  r.tracking = {100, 99, 80, 79, 2, 0.1 + 0.2, 0.25, 1.0 / 3, 0.5};
  const LapRow back = parse_line(csv_line(r, tracking), tracking);
  EXPECT_EQ(back.tracking.long_detected, 79);
  EXPECT_EQ(back.tracking.false_objects, 2);
  EXPECT_EQ(back.tracking.position_error, 0.1 + 0.2);
  EXPECT_EQ(back.tracking.yaw_error, 1.0 / 3);
  EXPECT_THROW(parse_line(csv_line(r, experiments), tracking), std::invalid_argument);
}

TEST(LapTableColumns, TellWhetherALapBeganInContact) {
  LapRow r = row(1, 0);
  EXPECT_TRUE(began_in_contact(r, {1.24, -3.01, 0.3}));
  EXPECT_FALSE(began_in_contact(r, {0.5, 2.125, 0})) << "the place of the second collision";
  r.contact_points = "";
  EXPECT_FALSE(began_in_contact(r, {0, 0, 0}));
}

class LapTable : public testing::TemporaryFolder {
 protected:
  void write(const std::string& text) const { TemporaryFolder::write("laps.csv", text); }
  std::string complaint(const std::string& text, bool accept_truncated = false,
                        std::uint64_t seed0 = 0) const {
    write(text);
    try {
      read_rows(file_, experiments, accept_truncated, seed0);
    } catch (const IoError& error) {
      return error.what();
    }
    return {};
  }

  const fs::path file_ = folder_ / "laps.csv";
  static std::string line(const LapRow& row) { return checked_line(csv_line(row, experiments)) + "\n"; }
  std::string head_ = checked_header() + "\n", first_ = line(row(0, 2)), second_ = line(row(1, 0));
};

TEST_F(LapTable, ReadsBackToTheSameBits) {
  write(head_ + first_ + second_);
  const auto rows = read_rows(file_, experiments, false, 0);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].experiment, 0);
  EXPECT_EQ(rows[0].lap, 2);
  EXPECT_EQ(rows[1].experiment, 1);
  EXPECT_EQ(rows[0].seed, 10u);
  EXPECT_EQ(rows[1].state_cost, 0.1 + 0.2);
  EXPECT_EQ(rows[1].collision_cost, 1e-300);
  EXPECT_EQ(rows[1].time, 1.0 / 3);
  EXPECT_EQ(rows[1].contact_points, "1.250:-3.000 0.500:2.125");
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(line(rows[i]), i == 0 ? first_ : second_);
}

TEST_F(LapTable, BeginsWithTheColumnsOfThePublishedLogs) {
  EXPECT_EQ(head_.rfind("method,scenario,set,lap,seed,success,collision,timeout,state_cost,collision_cost,"
                        "input_error,mean_calculation_time,max_calculation_time,min_calculation_time,",
                        0),
            0u);
}

TEST_F(LapTable, AcceptsATruncatedLineOnlyAtTheEndOfAJournal) {
  const std::string cut = second_.substr(0, second_.size() / 2);
  write(head_ + first_ + cut);
  EXPECT_EQ(read_rows(file_, experiments, true, 0).size(), 1u);
  EXPECT_NE(complaint(head_ + first_ + cut).find(":3: is truncated"), std::string::npos);
  EXPECT_NE(complaint(head_ + cut + "\n" + first_, true).find(":2: checksum"), std::string::npos);
}

TEST_F(LapTable, NamesLineAndColumnOfAnInvalidValue) {
  const std::string plain = csv_line(row(0, 2), experiments), seed = ",,2,10,";
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = plain;
    text.replace(text.find(from), from.size(), to);
    return complaint(head_ + checked_line(text) + "\n");
  };
  EXPECT_NE(complaint("lap,seed\n" + first_).find(":1: the columns must be method,"), std::string::npos);
  EXPECT_NE(complaint(head_ + first_ + first_).find(":3: duplicate lap"), std::string::npos);
  EXPECT_NE(changed("mppi", "cem").find(":2: matches no experiment"), std::string::npos);
  EXPECT_NE(changed(seed, ",,3,10,").find("lap: 3 must be in [0, 2]"), std::string::npos);
  EXPECT_NE(changed(seed, ",,2,twelve,").find("seed: 'twelve' must be a number"), std::string::npos);
}

TEST_F(LapTable, RejectsNonFiniteNumbers) {
  LapRow invalid = row(0, 2);
  for (const double number : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    invalid.state_cost = number;
    EXPECT_NE(complaint(head_ + line(invalid)).find(":2: state_cost: '"), std::string::npos) << number;
  }
  invalid = row(0, 2);
  invalid.min_clearance = std::numeric_limits<double>::infinity();
  EXPECT_EQ(complaint(head_ + line(invalid)), "") << "where there is no wall";
}

TEST_F(LapTable, RejectsTheSeedOfAnotherLap) {
  LapRow plain = row(0, 2), among_obstacles = row(1, 1);
  plain.seed = 7 + 2 * 5;
  among_obstacles.seed = 7 + 1 * 10;
  const auto text = [&] { return head_ + line(plain) + line(among_obstacles); };
  EXPECT_EQ(complaint(text(), false, 7), "");
  EXPECT_NE(complaint(text(), false, 8).find(":2: seed: 17 must be 18"), std::string::npos);
  among_obstacles.seed = 7 + 1 * 5;
  EXPECT_NE(complaint(text(), true, 7).find(":3: seed: 12 must be 17"), std::string::npos);
}

TEST_F(LapTable, NamesAMissingHeader) {
  EXPECT_NE(complaint("").find(".csv:1: the header is missing"), std::string::npos);
  EXPECT_EQ(complaint("", true), "") << "a journal that was killed at once";
}

}  // namespace
}  // namespace slalom::evaluation
