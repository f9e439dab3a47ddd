#include "slalom/core/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slalom {
namespace {

TEST(FillNormal, ValueDependsOnKeyRowAndSampleAlone) {
  SequenceBatch whole(5, 2, 640), parts(5, 2, 640);
  fill_normal(whole, 0, 640, {7, 3});
  fill_normal(parts, 320, 320, {7, 3});
  fill_normal(parts, 0, 320, {7, 3});
  SequenceBatch other(5, 2, 640);
  fill_normal(other, 0, 640, {7, 4});
  int equal = 0;
  for (int t = 0; t < 5; ++t)
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 640; ++k) {
        ASSERT_EQ(whole.at(t, i, k), parts.at(t, i, k));
        equal += whole.at(t, i, k) == other.at(t, i, k);
      }
  EXPECT_LT(equal, 3);
}

TEST(FillNormal, HasTheMomentsAndTailsOfANormal) {
  const int rows = 16, samples = 1 << 18;
  SequenceBatch batch(rows, 1, samples);
  fill_normal(batch, 0, samples, {1, 1});
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  long beyond3 = 0, beyond4 = 0;
  double largest = 0;
  for (int t = 0; t < rows; ++t)
    for (int k = 0; k < samples; ++k) {
      const double x = batch.at(t, 0, k);
      m1 += x;
      m2 += x * x;
      m3 += x * x * x;
      m4 += x * x * x * x;
      beyond3 += std::abs(x) > 3;
      beyond4 += std::abs(x) > 4;
      largest = std::max(largest, std::abs(x));
    }
  const double n = double(rows) * samples;
  EXPECT_NEAR(m1 / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(m2 / n, 1, 5 * std::sqrt(2 / n));
  EXPECT_NEAR(m3 / n, 0, 5 * std::sqrt(15 / n));
  EXPECT_NEAR(m4 / n, 3, 5 * std::sqrt(96 / n));
  const double p3 = std::erfc(3 / std::sqrt(2.0)), p4 = std::erfc(4 / std::sqrt(2.0));
  EXPECT_NEAR(beyond3 / n, p3, 5 * std::sqrt(p3 / n));
  EXPECT_NEAR(beyond4 / n, p4, 5 * std::sqrt(p4 / n));
  EXPECT_GT(largest, 4.7);
  EXPECT_LT(largest, 6.7);
}

TEST(RandomStream, UniformFillsItsRangeEvenly) {
  RandomStream stream({42, 0});
  std::vector<int> bins(64);
  const int n = 1 << 16;
  for (int i = 0; i < n; ++i) ++bins[static_cast<std::size_t>(stream.uniform() * 64)];
  double chi2 = 0;
  for (int count : bins) chi2 += (count - n / 64.0) * (count - n / 64.0) / (n / 64.0);
  EXPECT_LT(chi2, 120);  // 63 degrees of freedom: the 1e-5 quantile is 123
  EXPECT_GT(chi2, 25);
}

}  // namespace
}  // namespace slalom
