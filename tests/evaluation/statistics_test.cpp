#include "slalom/evaluation/statistics.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "slalom/core/random.hpp"

namespace slalom::evaluation::statistics_test {
namespace {

TEST(Wilson, KnownValues) {
  const Interval none = wilson_interval(0, 10), some = wilson_interval(16, 210),
                 all = wilson_interval(10, 10);
  EXPECT_DOUBLE_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 0.27753, 1e-5);  // z^2 / (n + z^2)
  EXPECT_NEAR(some.low, 0.0475, 5e-4);
  EXPECT_NEAR(some.high, 0.1203, 5e-4);
  EXPECT_NEAR(all.low, 1 - 0.27753, 1e-5);
  EXPECT_DOUBLE_EQ(all.high, 1);
  EXPECT_DOUBLE_EQ(wilson_interval(12, 10).high, 1);
  EXPECT_DOUBLE_EQ(wilson_interval(0, 0).high, 1);
}

TEST(Bootstrap, IntervalOfAMeanHasItsNominalCoverage) {
  RandomStream random({5, 0});
  int covered = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<double> values(60);
    for (double& v : values) v = 2 + random.normal();
    const Interval i = bootstrap_mean(values, static_cast<std::uint64_t>(trial), 500);
    covered += i.low <= 2 && 2 <= i.high;
  }
  EXPECT_GT(covered, 300 * 0.89);
  EXPECT_LT(covered, 300 * 0.99);
}

TEST(Bootstrap, IsDeterministicAndAcceptsNoValues) {
  const std::vector<double> values{1, 2, 5, 9};
  EXPECT_EQ(bootstrap_mean(values).low, bootstrap_mean(values).low);
  EXPECT_TRUE(std::isnan(bootstrap_mean({}).low));
  EXPECT_TRUE(std::isnan(bootstrap_ratio(values, std::vector<double>{0, 0, 0, 0}).low));
  EXPECT_TRUE(std::isnan(bootstrap_mean(values, 1, 0).low));
  // One resample of many laps of which one has obstacles: for some seeds it does not draw this lap.
  std::vector<double> laps(100, 1.0), obstacles(100, 0.0);
  obstacles[0] = 5;
  int without = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    without += std::isnan(bootstrap_ratio(laps, obstacles, seed, 1).low);
  EXPECT_GT(without, 0);
  EXPECT_LT(without, 20);
}

TEST(Bootstrap, DetectsADifference) {
  RandomStream random({6, 0});
  std::vector<double> a(40), b(40), c(40);
  for (std::size_t i = 0; i < 40; ++i) {
    a[i] = random.normal();
    b[i] = random.normal();
    c[i] = 1.5 + random.normal();
  }
  EXPECT_GT(bootstrap_difference_p(a, b), 0.05);
  EXPECT_LT(bootstrap_difference_p(a, c), 0.001);
}

TEST(McNemar, ExactBinomial) {
  EXPECT_DOUBLE_EQ(mcnemar_p(0, 0), 1);
  EXPECT_NEAR(mcnemar_p(0, 5), 2 * std::pow(0.5, 5), 1e-12);
  EXPECT_NEAR(mcnemar_p(1, 5), 2 * 7 * std::pow(0.5, 6), 1e-12);
  EXPECT_DOUBLE_EQ(mcnemar_p(4, 4), 1);
}

TEST(Wilcoxon, ExactAndApproximate) {
  const std::vector<double> all_up{0.1, 0.2, 0.3, 0.4, 0.5};
  EXPECT_NEAR(wilcoxon_p(all_up), 2.0 / 32, 1e-12);
  const std::vector<double> even{1, -1.5, 2, -2.5};
  EXPECT_GT(wilcoxon_p(even), 0.5);
  EXPECT_DOUBLE_EQ(wilcoxon_p(std::vector<double>{0, 0, 0}), 1);
  std::vector<double> many;
  for (int i = 1; i <= 80; ++i) many.push_back(i % 4 ? i : -i);
  EXPECT_NEAR(wilcoxon_p(many), 1.85e-4, 1e-6);  // z = (780 - 0.5) / 208.5
  std::vector<double> tied(20, 1.0);
  tied.resize(30, -1.0);
  EXPECT_NEAR(wilcoxon_p(tied), 0.069, 0.01);
}

TEST(PermutationTest, CountsArrangementsAtLeastAsExtreme) {
  // Two of the 20 ways to choose 3 of 6 are as extreme as 1, 2, 3 beside 4, 5, 6.
  const std::vector<double> low{1, 2, 3}, high{4, 5, 6};
  EXPECT_NEAR(permutation_difference_p(low, high), 0.1, 0.01);
  EXPECT_DOUBLE_EQ(permutation_difference_p(low, low), 1);
  const std::vector<double> many(30, 3.0), far{13, 14, 15};
  EXPECT_LT(permutation_difference_p(far, many), 0.002);
  EXPECT_TRUE(std::isnan(permutation_difference_p({}, low)));
}

TEST(Bootstrap, IntervalOfADifferenceContainsIt) {
  const std::vector<double> a{3, 5}, b{1, 1};
  const Interval interval = bootstrap_difference(a, b);
  EXPECT_DOUBLE_EQ(interval.low, 2);
  EXPECT_DOUBLE_EQ(interval.high, 4);
}

TEST(Percentile, IsTheNearestRank) {
  std::vector<double> values;
  for (int i = 1; i <= 100; ++i) values.push_back(i);
  EXPECT_EQ(percentile(values, 0.07), 7) << "0.07 * 100 is above 7 in doubles";
  for (const auto& [share, value] : {std::pair{0.0, 1}, {0.5, 50}, {0.501, 51}, {0.99, 99}, {1.0, 100}})
    EXPECT_EQ(percentile(values, share), value) << share;
  EXPECT_EQ(percentile(std::vector<float>{1, 2, 4}, 0.5), 2);
  EXPECT_EQ(percentile(std::vector<float>{1, 2}, 0.5), 1);
  EXPECT_EQ(percentile(std::vector<float>{3}, 0.99), 3);
  EXPECT_TRUE(std::isnan(percentile(std::vector<double>{}, 0.5)));
}

TEST(RateDifferenceInterval, MatchesTheExampleOfNewcombe) {
  // Table II, column (a): 56/70 - 48/80, method 10.
  const Interval interval = rate_difference_interval(56, 70, 48, 80);
  EXPECT_NEAR(interval.low, 0.0524, 5e-5);
  EXPECT_NEAR(interval.high, 0.3339, 5e-5);
}

}  // namespace
}  // namespace slalom::evaluation::statistics_test
