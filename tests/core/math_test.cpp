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

TEST(PackMath, Generic) {
  check_functions<Pack<simd::Generic>>();
}
#if SLALOM_X86
SLALOM_TARGET_SSE4 void check_sse4() {
  check_functions<Pack<simd::Sse4>>();
}
SLALOM_TARGET_AVX2 void check_avx2() {
  check_functions<Pack<simd::Avx2>>();
}
SLALOM_TARGET_AVX512 void check_avx512() {
  check_functions<Pack<simd::Avx512>>();
}
TEST(PackMath, Sse4) {
  if (!simd::supported(simd::Target::sse4)) GTEST_SKIP() << "this processor has no SSE4.2";
  check_sse4();
}
TEST(PackMath, Avx2) {
  if (!simd::supported(simd::Target::avx2)) GTEST_SKIP() << "this processor has no AVX2";
  check_avx2();
}
TEST(PackMath, Avx512) {
  if (!simd::supported(simd::Target::avx512)) GTEST_SKIP() << "this processor has no AVX-512";
  check_avx512();
}
#endif

}  // namespace
}  // namespace slalom
