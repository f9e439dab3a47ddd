// The search for options: the design, successive halving, the objective.
#include "slalom/evaluation/tuning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>

namespace slalom::evaluation {
namespace {

const vehicle::Configuration configuration;

TEST(SearchDimension, RangesEndWhereTheySay) {
  const auto number = parse_dimension("variance=0.01:0.04", configuration, "mppi");
  EXPECT_EQ(number.key, "mppi.variance");
  EXPECT_EQ(number.value(0), "0.01");
  EXPECT_EQ(number.value(0.5), "0.025");
  EXPECT_EQ(number.value(1), "0.04");
  const auto logarithmic = parse_dimension("mppi.variance=0.001:0.1:log", configuration, "svg_mppi");
  EXPECT_EQ(logarithmic.value(0.5), "0.01");
  EXPECT_NEAR(logarithmic.place("0.01"), 0.5, 1e-12);
  EXPECT_EQ(logarithmic.place("7"), 1) << "the nearest place";
}

TEST(SearchDimension, WholeNumbersAreEquallyLikely) {
  const auto whole = parse_dimension("guides=1:4", configuration, "svg_mppi");
  std::map<std::string, int> counts;
  for (int i = 0; i < 400; ++i) ++counts[whole.value((i + 0.5) / 400)];
  ASSERT_EQ(counts.size(), 4u);
  for (const auto& [value, count] : counts) EXPECT_EQ(count, 100) << value;
  EXPECT_EQ(whole.value(1), "4");
  for (const char* value : {"1", "2", "3", "4"}) EXPECT_EQ(whole.value(whole.place(value)), value);
}

TEST(SearchDimension, Choices) {
  const auto choice = parse_dimension("vehicle.body=box,discs", configuration, "svg_mppi");
  EXPECT_EQ(choice.value(0.2), "box");
  EXPECT_EQ(choice.value(0.9), "discs");
  EXPECT_EQ(choice.value(choice.place("discs")), "discs");
}

TEST(SearchDimension, RejectsInvalidText) {
  for (const char* text : {"", "variance", "=1:2", "variance=2:1", "variance=1:1", "variance=0:1:log",
                           "variance=1:2:3", "variance=a:b", "variance=0.1", "guides=1.5:3", "samples=-4:3",
                           "nothing=1:2", "vehicle.body=box,cube"})
    EXPECT_THROW(parse_dimension(text, configuration, "svg_mppi"), std::invalid_argument) << text;
}

TEST(SearchDesign, FillsTheBoxEvenly) {
  const std::vector<SearchDimension> dimensions{
      parse_dimension("mppi.variance=0.001:0.1:log", configuration, "mppi"),
      parse_dimension("mppi.temperature=1:9", configuration, "mppi")};
  const auto whole = design(dimensions, {0.5, 0.5}, 1, 0, 64);
  int cells[16] = {};
  for (const Candidate& c : whole) {
    for (const double place : c.place) ASSERT_TRUE(place >= 0 && place < 1);
    ++cells[static_cast<int>(c.place[0] * 4) * 4 + static_cast<int>(c.place[1] * 4)];
    EXPECT_EQ(c.set[0].first, "mppi.variance");
    EXPECT_EQ(c.set[1].second, dimensions[1].value(c.place[1]));
  }
  for (const int count : cells) {
    EXPECT_GE(count, 2) << "of 4 in the mean";
    EXPECT_LE(count, 6);
  }
  for (const Candidate& c : design(dimensions, {0.05, 0.7}, 0.25, 64, 20)) {
    EXPECT_TRUE(c.place[0] >= 0 && c.place[0] <= 0.25) << "pushed inwards";
    EXPECT_TRUE(c.place[1] >= 0.575 && c.place[1] <= 0.825);
  }
}

TEST(SuccessiveHalving, HalvesTheCandidatesAndDoublesTheLaps) {
  const auto rungs = halving(9, 3);
  ASSERT_EQ(rungs.size(), 4u);
  const int candidates[] = {9, 5, 3, 2}, laps[] = {3, 6, 12, 24};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(rungs[i].candidates, candidates[i]);
    EXPECT_EQ(rungs[i].laps, laps[i]);
  }
  EXPECT_EQ(laps_of(rungs), 9 * 3 + 5 * 3 + 3 * 6 + 2 * 12) << "no lap is driven twice";
  EXPECT_TRUE(halving(1, 3).empty());
  for (const int budget : {5, 6, 40, 100, 1000}) {
    const int n = candidates_for(budget, 3);
    EXPECT_LE(laps_of(halving(n, 3)), budget);
    EXPECT_GT(laps_of(halving(n + 1, 3)), budget);
  }
}

TEST(TuningObjective, IsASumOfFigures) {
  LapRow row;
  row.state_cost = 0.5;
  row.collision_cost = 2;
  row.collisions = 3;
  row.success = false;
  row.lap_time = 17;
  EXPECT_EQ(Objective("ms").of(row), 2.5);
  EXPECT_EQ(Objective("ms + 10*failures+2 contacts").of(row), 18.5);
  EXPECT_EQ(Objective("0.5lap_time").of(row), 8.5);
  EXPECT_NEAR(Objective("log_ms").of(row), std::log(2.501), 1e-12);
  for (const char* text : {"", "ms+", "speed", "-1*ms", "ms*3", "3"})
    EXPECT_THROW(Objective{text}, std::invalid_argument) << text;
}

TEST(SearchDimension, RangesAndWeightsStayFinite) {
  EXPECT_THROW(parse_dimension("mppi.temperature=1e-320:1:log", configuration, "mppi"),
               std::invalid_argument);
  EXPECT_THROW(parse_dimension("mppi.temperature=-1e308:1e308", configuration, "mppi"),
               std::invalid_argument);
  EXPECT_THROW(Objective("1" + std::string(308, '0') + " ms + 1" + std::string(308, '0') + " ms"),
               std::invalid_argument);
}

}  // namespace
}  // namespace slalom::evaluation
