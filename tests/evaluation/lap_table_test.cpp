// laps.csv reads back to the same bits, and says what is wrong where it does not.
#include "slalom/evaluation/lap_table.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "slalom/core/error.hpp"

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
  r.seed = 18446744073709551615ull;
  r.success = true;
  r.collision = 3;
  r.finished = true;
  r.state_cost = 0.1 + 0.2;
  r.collision_cost = 1e-300;
  r.impassable = 2;
  r.lap_time = 1.0 / 3;
  r.minimum_clearance = -0.0125;
  r.contact_points = "1.250:-3.000 0.500:2.125";
  r.solve_p99 = 12.5;
  return r;
}

class LapTable : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    file_ = fs::temp_directory_path() / (std::string("slalom_lap_table.") + test->name() + ".csv");
  }
  void TearDown() override { fs::remove(file_); }

  void write(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }
  std::string complaint(const std::string& text, bool forgive_last = false) const {
    write(text);
    try {
      read_rows(file_, experiments, forgive_last);
    } catch (const IoError& error) {
      return error.what();
    }
    return {};
  }

  fs::path file_;
  std::string head_ = csv_header() + "\n", first_ = csv_line(row(0, 2), experiments) + "\n",
              second_ = csv_line(row(1, 0), experiments) + "\n";
};

TEST_F(LapTable, ReadsBackToTheSameBits) {
  write(head_ + first_ + second_);
  const auto rows = read_rows(file_, experiments, false);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].experiment, 0);
  EXPECT_EQ(rows[0].lap, 2);
  EXPECT_EQ(rows[1].experiment, 1);
  EXPECT_EQ(rows[1].seed, 18446744073709551615ull);
  EXPECT_EQ(rows[1].state_cost, 0.1 + 0.2);
  EXPECT_EQ(rows[1].collision_cost, 1e-300);
  EXPECT_EQ(rows[1].lap_time, 1.0 / 3);
  EXPECT_EQ(rows[1].contact_points, "1.250:-3.000 0.500:2.125");
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(csv_line(rows[i], experiments) + "\n", i == 0 ? first_ : second_);
}

TEST_F(LapTable, BeginsWithTheColumnsOfThePublishedLogs) {
  EXPECT_EQ(head_.rfind("method,scenario,set,lap,seed,success,collision,timeout,state_cost,collision_cost,"
                        "input_error,mean_calculation_time,max_calculation_time,min_calculation_time,",
                        0),
            0u);
}

TEST_F(LapTable, ForgivesALineCutShortOnlyAtTheEndOfAJournal) {
  const std::string cut = second_.substr(0, second_.size() / 2);
  write(head_ + first_ + cut);
  EXPECT_EQ(read_rows(file_, experiments, true).size(), 1u);
  EXPECT_NE(complaint(head_ + first_ + cut).find(":3: is cut short"), std::string::npos);
  EXPECT_NE(complaint(head_ + cut + "\n" + first_, true).find(":2: has "), std::string::npos);
}

TEST_F(LapTable, NamesLineAndColumnOfWhatMakesNoSense) {
  EXPECT_NE(complaint("lap,seed\n" + first_).find(":1: column method: is missing"), std::string::npos);
  EXPECT_NE(complaint(head_ + first_ + first_).find(":3: lap: stands here twice"), std::string::npos);
  std::string other = first_;
  other.replace(0, 4, "cem");
  EXPECT_NE(complaint(head_ + other).find(":2: is of no experiment"), std::string::npos);
  std::string lap = first_;
  lap.replace(lap.find(",,2,"), 4, ",,3,");
  EXPECT_NE(complaint(head_ + lap).find("lap: 3 is not one of this evaluation"), std::string::npos);
  std::string word = first_;
  word.replace(word.find("18446744073709551615"), 20, "twelve");
  EXPECT_NE(complaint(head_ + word).find("seed: 'twelve' must be a number"), std::string::npos);
}

}  // namespace
}  // namespace slalom::evaluation
