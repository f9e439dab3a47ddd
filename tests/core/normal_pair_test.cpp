#include "core/normal_pair.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slalom {
namespace {

using F = Pack<simd::Generic>;
using Unsigned = simd::detail::VectorTypes<F::lanes>::Unsigned;

constexpr std::uint32_t block = 1u << 16;

/// The pairs of `block` words from `first` on.
SLALOM_TARGET_GENERIC void pairs_from(std::uint32_t first, float* x, float* y) {
  Unsigned lane{};
  for (int i = 0; i < F::lanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
  for (std::uint32_t k = 0; k < block; k += F::lanes) {
    F even, odd;
    detail::normal_pair<F>(Unsigned(lane + (first + k)), even, odd);
    even.store(x + k);
    odd.store(y + k);
  }
}

/// Means of powers, and how many values lie beyond 3, 4 and 5.
struct ValueStatistics {
  double power[5] = {};
  std::int64_t above[3] = {}, below[3] = {};

  void add(const std::vector<float>& values) {
    constexpr double share = 1.0 / 4294967296.0;
    double sum[5] = {};
    for (const float value : values) {
      const double x = value, square = x * x;
      sum[1] += x;
      sum[2] += square;
      sum[3] += x * square;
      sum[4] += square * square;
      for (int i = 0; i < 3 && std::abs(value) > static_cast<float>(3 + i); ++i) ++(x > 0 ? above : below)[i];
    }
    for (int k = 1; k <= 4; ++k) power[k] += share * sum[k];
  }
};

/// Not a sample: every pair there is.
TEST(NormalPair, AllPairsTogetherAreNormal) {
  ValueStatistics x, y;
  double product = 0, squares = 0;
  std::vector<float> even(block), odd(block);
  for (std::uint32_t part = 0; part < 65536; ++part) {
    pairs_from(part * block, even.data(), odd.data());
    x.add(even);
    y.add(odd);
    double sum = 0, sum_of_squares = 0;
    for (std::size_t k = 0; k < block; ++k) {
      const double both = static_cast<double>(even[k]) * static_cast<double>(odd[k]);
      sum += both;
      sum_of_squares += both * both;
    }
    product += sum / 4294967296.0;
    squares += sum_of_squares / 4294967296.0;
  }
  EXPECT_NEAR(product, 0, 2e-6);
  EXPECT_NEAR(squares, 1, 2e-6);
  for (const ValueStatistics& each : {x, y}) {
    EXPECT_NEAR(each.power[1], 0, 1e-9);
    EXPECT_NEAR(each.power[2], 1, 2e-6);
    EXPECT_NEAR(each.power[3], 0, 1e-9);
    EXPECT_NEAR(each.power[4], 3, 2e-5);
    for (int i = 0; i < 3; ++i) {
      const double expected = 0.5 * std::erfc((3 + i) / std::sqrt(2.0)) * 4294967296.0;
      // One standard deviation of as many independent draws.
      EXPECT_NEAR(each.above[i], expected, std::sqrt(expected)) << "beyond " << 3 + i;
      EXPECT_EQ(each.above[i], each.below[i]);
    }
  }
}

}  // namespace
}  // namespace slalom
