#include "slalom/core/math.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "slalom/core/dispatch.hpp"

namespace slalom {
namespace {

/// Largest error of a pack function against double over a range, relative to max(1, |value|).
template <class F, class Function, class Exact>
double largest_error(double low, double high, Function function, Exact exact) {
  double worst = 0;
  for (int i = 0; i < 20000; i += F::lanes) {
    float x[F::lanes], y[F::lanes];
    for (int j = 0; j < F::lanes; ++j) x[j] = static_cast<float>(low + (high - low) * (i + j) / 20000);
    function(F::load(x)).store(y);
    for (int j = 0; j < F::lanes; ++j) {
      const double e = exact(double(x[j]));
      worst = std::max(worst, std::abs(y[j] - e) / std::max(1.0, std::abs(e)));
    }
  }
  return worst;
}

template <class F>
void check_functions() {
  EXPECT_LT((largest_error<F>(
                -100, 100, [](F x) { return sin(x); }, [](double x) { return std::sin(x); })),
            3e-7);
  EXPECT_LT((largest_error<F>(
                -100, 100, [](F x) { return cos(x); }, [](double x) { return std::cos(x); })),
            3e-7);
  EXPECT_LT((largest_error<F>(
                -1.4, 1.4, [](F x) { return tan(x); }, [](double x) { return std::tan(x); })),
            1e-6);
  EXPECT_LT((largest_error<F>(
                -9, 9, [](F x) { return atan(x); }, [](double x) { return std::atan(x); })),
            3e-7);
  EXPECT_LT((largest_error<F>(
                -80, 80, [](F x) { return exp(x); }, [](double x) { return std::exp(x); })),
            1e-6);
  EXPECT_LT((largest_error<F>(
                1e-6, 50, [](F x) { return log(x); }, [](double x) { return std::log(x); })),
            3e-7);
  EXPECT_LT((largest_error<F>(
                0, 50, [](F x) { return sqrt(x); }, [](double x) { return std::sqrt(x); })),
            1e-7);
  EXPECT_LT((largest_error<F>(
                0.1, 50, [](F x) { return reciprocal_sqrt(x); }, [](double x) { return 1 / std::sqrt(x); })),
            4e-7);
  EXPECT_EQ((largest_error<F>(
                -50, 50, [](F x) { return round(x); }, [](double x) { return std::nearbyint(x); })),
            0);
  EXPECT_EQ((largest_error<F>(
                -5, 5, [](F x) { return clamp(x, -1, 2); },
                [](double x) { return std::min(2.0, std::max(-1.0, x)); })),
            0);
  EXPECT_LT((largest_error<F>(
                -20, 20, [](F x) { return wrap_angle(x); },
                [](double x) { return std::remainder(x, 6.283185307179586); })),
            3e-6);
}

struct CheckFunctions {
  template <class Target>
  SLALOM_KERNEL static void run() {
    check_functions<Pack<Target>>();
  }
};

/// x x - (1 + 2^-11) for x = 1 + 2^-12, whose square needs a bit more than a float32 has.
template <bool unfused>
struct SquareLess {
  template <class Target>
  SLALOM_KERNEL static float run(const float* x) {
    using F = Pack<std::conditional_t<unfused, simd::Unfused<Target>, Target>>;
    const F value = F::load(x);
    return (value * value - F(1.00048828125f))[0];
  }
};

class PackMath : public testing::TestWithParam<simd::Target> {};

TEST_P(PackMath, IsAccurateOnEveryInstructionSet) {
  if (!simd::supported(GetParam())) GTEST_SKIP() << "this processor has no " << simd::name(GetParam());
  simd::kernel<CheckFunctions>(GetParam())();
}

TEST_P(PackMath, UnfusedPacksRoundProducts) {
  if (!simd::supported(GetParam())) GTEST_SKIP() << "this processor has no " << simd::name(GetParam());
  float x[16];
  for (float& value : x) value = 1.000244140625f;
  EXPECT_EQ(simd::kernel<SquareLess<true>>(GetParam())(x), 0.0f);
  // Only g++ fuses by itself, and only from -O2 on. The presets that compile with less do not define NDEBUG.
#if !defined(__clang__) && defined(NDEBUG) && SLALOM_X86
  const bool fuses = GetParam() == simd::Target::avx2 || GetParam() == simd::Target::avx512;
  EXPECT_EQ(simd::kernel<SquareLess<false>>(GetParam())(x), fuses ? 0x1p-24f : 0.0f);
#endif
}

INSTANTIATE_TEST_SUITE_P(Targets, PackMath,
                         testing::Values(simd::Target::generic, simd::Target::sse4, simd::Target::avx2,
                                         simd::Target::avx512),
                         [](const auto& target) { return simd::name(target.param); });

}  // namespace
}  // namespace slalom
