
#include <iterator>

#include "support/rollouts.hpp"

namespace slalom {
namespace {

/// The distance from one float32 to the next at a value.
double unit(double value) {
  const auto near = static_cast<float>(std::abs(value));
  return static_cast<double>(std::nextafter(near, std::numeric_limits<float>::infinity())) -
         static_cast<double>(near);
}

/// Applies a function to arrays of `count` values, in packs of an instruction set, or in pairs of them.
template <class Function, bool pairs = false>
struct Apply {
  template <class Target>
  SLALOM_KERNEL static void run(const float* x, const float* y, int count, float* result) {
    using F = std::conditional_t<pairs, PackPair<Target>, Pack<Target>>;
    for (int i = 0; i < count; i += F::lanes) Function{}(F::load(x + i), F::load(y + i)).store(result + i);
  }
};

/// A range of arguments, over which a grid is laid.
struct Span {
  double low, high;
};

/// The largest error of a function over a rectangle, as a share of `size` of the exact value. `Function`
/// takes packs and doubles.
template <class Function, class Size>
double largest_error(simd::Target target, Span first, Span second, std::size_t count, Size size) {
  constexpr int rows = 97;
  const int used = second.low < second.high ? rows : 1;
  std::vector<float> x(count), y(count), result(count);
  double worst = 0;
  for (int row = 0; row < used; ++row) {
    std::fill(y.begin(), y.end(), static_cast<float>(second.low + (second.high - second.low) * row / rows));
    for (std::size_t i = 0; i < count; ++i)
      x[i] = static_cast<float>(first.low + (first.high - first.low) * static_cast<double>(i) /
                                                static_cast<double>(count));
    simd::kernel<Apply<Function>>(target)(x.data(), y.data(), static_cast<int>(count), result.data());
    for (std::size_t i = 0; i < count; ++i) {
      const double exact = Function{}(static_cast<double>(x[i]), static_cast<double>(y[i]));
      worst = std::max(worst, std::abs(static_cast<double>(result[i]) - exact) / size(exact));
    }
  }
  return worst;
}

/// The largest error in units in the last place.
template <class Function>
double units(simd::Target target, Span first, Span second = {0, 0}) {
  return largest_error<Function>(target, first, second, 4096, unit);
}

/// The largest error relative to max(1, |value|).
template <class Function>
double relative(simd::Target target, Span first) {
  return largest_error<Function>(target, first, {0, 0}, 20000,
                                 [](double exact) { return std::max(1.0, std::abs(exact)); });
}

/// A function object with this expression in x and y.
#define SLALOM_FUNCTION(Name, expression)                            \
  struct Name {                                                      \
    template <class T>                                               \
    SLALOM_INLINE_CALLS T operator()(const T& x, const T& y) const { \
      static_cast<void>(y);                                          \
      return expression;                                             \
    }                                                                \
  }
SLALOM_FUNCTION(Sine, sin(x));
SLALOM_FUNCTION(Cosine, cos(x));
SLALOM_FUNCTION(Tan, tan(x));
SLALOM_FUNCTION(Atan, atan(x));
SLALOM_FUNCTION(Exp, exp(x));
SLALOM_FUNCTION(Log, log(x));
SLALOM_FUNCTION(Sqrt, sqrt(x));
SLALOM_FUNCTION(ReciprocalSqrt, reciprocal_sqrt(x));
SLALOM_FUNCTION(Round, round(x));
SLALOM_FUNCTION(Clamp, clamp(x, T(-1), T(2)));
SLALOM_FUNCTION(WrapAngle, wrap_angle(x));
SLALOM_FUNCTION(Tanh, tanh(x));
SLALOM_FUNCTION(Sinh, sinh(x));
SLALOM_FUNCTION(Cosh, cosh(x));
SLALOM_FUNCTION(Asin, asin(x));
SLALOM_FUNCTION(Acos, acos(x));
SLALOM_FUNCTION(Cbrt, cbrt(x));
SLALOM_FUNCTION(Exp2, exp2(x));
SLALOM_FUNCTION(Log1p, log1p(x));
SLALOM_FUNCTION(Floor, floor(x));
SLALOM_FUNCTION(Ceil, ceil(x));
SLALOM_FUNCTION(Sign, sign(x));
SLALOM_FUNCTION(Lerp, lerp(T(1), T(3), x));
SLALOM_FUNCTION(Atan2, atan2(x, y));
SLALOM_FUNCTION(Hypot, hypot(x, y));
SLALOM_FUNCTION(Pow, pow(x, y));
SLALOM_FUNCTION(Remainder, T(64) + fmod(x, y));

/// The first lane of a function of two numbers.
template <class Function>
float at(simd::Target target, float x, float y = 0) {
  float first[simd::padding], second[simd::padding], result[simd::padding];
  std::fill(std::begin(first), std::end(first), x);
  std::fill(std::begin(second), std::end(second), y);
  simd::kernel<Apply<Function>>(target)(first, second, simd::padding, result);
  return result[0];
}

SLALOM_FUNCTION(Fmod, fmod(x, y));
SLALOM_FUNCTION(Fma, fma(x, y, T(4)));

/// Masks of the lanes 0, 1, 2 ... as numbers: 1 where a lane is set.
SLALOM_FUNCTION(Or, select((x == T(0)) || (x == T(1)), T(1), T(0)));
SLALOM_FUNCTION(And, select((x >= T(1)) && !(x > T(2)), T(1), T(0)));
SLALOM_FUNCTION(Differs, select(x != y, T(1), T(0)));
SLALOM_FUNCTION(AnyAbove, any(x > y) ? T(1) : T(0));
SLALOM_FUNCTION(AllAbove, all(x > y) ? T(1) : T(0));

class PackFunctions : public testing::OnInstructionSet {};
SLALOM_ON_EVERY_INSTRUCTION_SET(PackFunctions);

TEST_P(PackFunctions, KeepTheirBoundsOfUnitsInTheLastPlace) {  // those that math.hpp states
  const simd::Target target = GetParam();
  EXPECT_LE(units<Tanh>(target, {-12, 12}), 3);
  EXPECT_LE(units<Tanh>(target, {-0.01, 0.01}), 3);
  EXPECT_LE(units<Sinh>(target, {-80, 80}), 4);
  EXPECT_LE(units<Sinh>(target, {-1.5, 1.5}), 4);
  EXPECT_LE(units<Cosh>(target, {-80, 80}), 4);
  EXPECT_LE(units<Asin>(target, {-1, 1}), 4);
  EXPECT_LE(units<Acos>(target, {-1, 1}), 4);
  EXPECT_LE(units<Acos>(target, {0.999, 1}), 4);
  EXPECT_LE(units<Cbrt>(target, {-1000, 1000}), 2);
  EXPECT_LE(units<Exp2>(target, {-125.5, 127.9}), 3);
  EXPECT_LE(units<Log1p>(target, {-0.9, 100}), 4);
  EXPECT_LE(units<Log1p>(target, {-1e-3, 1e-3}), 4);
  EXPECT_EQ(units<Floor>(target, {-3e6, 3e6}), 0);
  EXPECT_EQ(units<Floor>(target, {-4, 4}), 0);
  EXPECT_EQ(units<Ceil>(target, {-4, 4}), 0);
  EXPECT_EQ(units<Sign>(target, {-3, 3}), 0);
  EXPECT_LE(units<Lerp>(target, {0, 3}), 2);
  EXPECT_LE(units<Atan2>(target, {-5, 5}, {-5, 5}), 4);
  EXPECT_LE(units<Hypot>(target, {-5, 5}, {-5, 5}), 2);
  EXPECT_LE(units<Pow>(target, {0.1, 20}, {-2, 2}), 4 + 2 * std::log(20.0));
  EXPECT_LE(units<Remainder>(target, {-50, 50}, {0.3, 7}), 1.5);  // of a dividend up to 64
}

TEST_P(PackFunctions, AreAccurateOverTheirUsualRanges) {
  const simd::Target target = GetParam();
  EXPECT_LT(relative<Sine>(target, {-100, 100}), 3e-7);
  EXPECT_LT(relative<Cosine>(target, {-100, 100}), 3e-7);
  EXPECT_LT(relative<Tan>(target, {-1.4, 1.4}), 1e-6);
  EXPECT_LT(relative<Atan>(target, {-9, 9}), 3e-7);
  EXPECT_LT(relative<Exp>(target, {-80, 80}), 1e-6);
  EXPECT_LT(relative<Log>(target, {1e-6, 50}), 3e-7);
  EXPECT_LT(relative<Sqrt>(target, {0, 50}), 1e-7);
  EXPECT_LT(relative<ReciprocalSqrt>(target, {0.1, 50}), 4e-7);
  EXPECT_EQ(relative<Round>(target, {-50, 50}), 0);
  EXPECT_EQ(relative<Clamp>(target, {-5, 5}), 0);
  EXPECT_LT(relative<WrapAngle>(target, {-20, 20}), 3e-6);
}

TEST_P(PackFunctions, HaveTheSpecialValuesOfTheStandardLibrary) {
  const simd::Target target = GetParam();
  const float infinite = std::numeric_limits<float>::infinity(), nothing = std::nanf("");
  EXPECT_NEAR(at<Pow>(target, -2, 3), -8, 1e-5);
  EXPECT_NEAR(at<Pow>(target, -2, -2), 0.25, 1e-6);
  EXPECT_TRUE(std::isnan(at<Pow>(target, -2, 0.5f)));
  EXPECT_EQ(at<Pow>(target, 0, 2), 0);
  EXPECT_EQ(at<Pow>(target, 0, 0), 1);
  EXPECT_EQ(at<Pow>(target, 0, -1), infinite);
  EXPECT_EQ(at<Cbrt>(target, 0), 0);
  EXPECT_EQ(at<Hypot>(target, 0, 0), 0);
  EXPECT_LT(at<Hypot>(target, 1e38f, 1e38f), infinite);
  EXPECT_EQ(at<Exp2>(target, 3), 8);
  EXPECT_EQ(at<Exp2>(target, -200), 0);
  EXPECT_EQ(at<Exp2>(target, 200), infinite);
  EXPECT_TRUE(std::isnan(at<Exp2>(target, nothing)));
  EXPECT_EQ(at<Log1p>(target, -1), -infinite);
  EXPECT_EQ(at<Log1p>(target, infinite), infinite);
  EXPECT_TRUE(std::isnan(at<Log1p>(target, -2)));
  EXPECT_TRUE(std::isnan(at<Acos>(target, 1.5f)));
  EXPECT_EQ(at<Atan2>(target, 0, 0), 0);
  EXPECT_FLOAT_EQ(at<Atan2>(target, 0, -1), 3.14159265f);
  EXPECT_FLOAT_EQ(at<Atan2>(target, -0.0f, -1), -3.14159265f);
  EXPECT_EQ(at<Tanh>(target, 100), 1);
  EXPECT_EQ(at<Tanh>(target, -100), -1);
  EXPECT_EQ(at<Fmod>(target, -5, 3), -2);
  EXPECT_EQ(at<Fmod>(target, 6, 3), 0);
  EXPECT_EQ(at<Fma>(target, 2, 3), 10);
}

TEST_P(PackFunctions, CombineMasksLaneByLane) {
  const simd::Target target = GetParam();
  float x[simd::padding], y[simd::padding] = {}, result[simd::padding];
  for (int i = 0; i < simd::padding; ++i) x[i] = static_cast<float>(i % 4);
  x[4] = std::nanf("");
  const auto expect = [&](auto function, auto lane) {
    simd::kernel<Apply<decltype(function)>>(target)(x, y, simd::padding, result);
    for (int i = 0; i < simd::padding; ++i) EXPECT_EQ(result[i], lane(x[i]) ? 1 : 0) << i;
  };
  expect(Or{}, [](float v) { return v == 0 || v == 1; });
  expect(And{}, [](float v) { return v == 1 || v == 2; });
  expect(Differs{}, [](float v) { return v != 0; });
  EXPECT_EQ(at<AnyAbove>(target, 1, 0), 1);
  EXPECT_EQ(at<AllAbove>(target, 1, 0), 1);
  EXPECT_EQ(at<AnyAbove>(target, 0, 0), 0);
  x[0] = -1;
  x[1] = x[2] = x[3] = 1;
  simd::kernel<Apply<AnyAbove>>(target)(x, y, simd::padding, result);
  EXPECT_EQ(result[0], 1);
  simd::kernel<Apply<AllAbove>>(target)(x, y, simd::padding, result);
  EXPECT_EQ(result[0], 0);
}

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

TEST_P(PackFunctions, UnfusedPacksRoundProducts) {
  float x[16];
  for (float& value : x) value = 1.000244140625f;
  EXPECT_EQ(simd::kernel<SquareLess<true>>(GetParam())(x), 0.0f);
  // Only g++ fuses by itself, and only from -O2 on. The presets that compile with less do not define NDEBUG.
#if !defined(__clang__) && defined(NDEBUG) && SLALOM_X86
  const bool fuses = GetParam() == simd::Target::avx2 || GetParam() == simd::Target::avx512;
  EXPECT_EQ(simd::kernel<SquareLess<false>>(GetParam())(x), fuses ? 0x1p-24f : 0.0f);
#endif
}

TEST(ScalarFunctions, AreThoseOfTheStandardLibrary) {
  EXPECT_EQ(slalom::tanh(0.3), std::tanh(0.3));
  EXPECT_EQ(slalom::atan2(1.0, -2.0), std::atan2(1.0, -2.0));
  EXPECT_EQ(slalom::pow(2.0, 0.5), std::pow(2.0, 0.5));
  EXPECT_EQ(slalom::sign(-3.0), -1);
  EXPECT_EQ(slalom::clamp(-3.0, -1.0, 2.0), -1);
  for (const double x : {-20.0, -2.5, 0.7, 1.5, 2.5, 9.4}) {
    EXPECT_EQ(slalom::round(x), std::nearbyint(x));
    EXPECT_NEAR(slalom::wrap_angle(x), std::remainder(x, 6.283185307179586), 1e-12);
    EXPECT_NEAR(slalom::reciprocal_sqrt(std::abs(x)), 1 / std::sqrt(std::abs(x)), 1e-15);
  }
  EXPECT_EQ(slalom::lerp(1.0, 3.0, 0.25), 1.5);
  EXPECT_TRUE(slalom::any(true) && slalom::all(true) && !slalom::any(false));
}

/// Every operation and function of pairs, of two values in (0, 1).
struct AllOperations {
  template <class T>
  SLALOM_INLINE T operator()(const T& x, const T& y) const {
    T sine, cosine;
    sin_cos(T(9) * x, sine, cosine);
    T sum = sine + 2 * cosine + sin(x) * cos(y) + tan(x) / (1 + exp(y)) - log(x) * atan(y) + tanh(x - y);
    sum += min(x, y) + max(x, T(0.5)) * copysign(y, x - y) + hypot(x, y) + atan2(y, x) + abs(x - y);
    sum -= floor(3 * x) + ceil(3 * y) + round(5 * x) + sqrt(x) + reciprocal_sqrt(y) + wrap_angle(20 * x);
    sum *= select((x < y) & !(x >= 0.7), -x, y) + select((x > 0.2) | (x == y), T(1), T(2));
    sum /= select((x <= y) && (x != y), square(x) + 1, clamp(y, 0.25, 0.75)) +
           select((x < 0.1) || (y < 0.1), T(0.5), T(0));
    sum += pow(x, y) + fmod(3 * x, y) + fma(x, y, x) + lerp(x, y, T(0.3)) + cbrt(x - y) * sign(x - y);
    sum -= asin(x) * acos(y) + sinh(x) * cosh(y) + exp2(x) * log1p(y);
    return sum + (any(x < 0) ? T(1000) : T(0)) + (all(x > 0) ? T(0) : T(1000));
  }
};

TEST(PackPair, ComputesWhatItsHalvesDo) {
  std::vector<float> x(96), y(96);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = (static_cast<float>(i) + 0.5f) / 96;
    y[i] = std::fmod(static_cast<float>(i) * 0.618f + 0.1f, 1.0f);
  }
  for (const simd::Target target : testing::instruction_sets()) {
    std::vector<float> halves(96), pairs(96);
    simd::kernel<Apply<AllOperations>>(target)(x.data(), y.data(), 96, halves.data());
    simd::kernel<Apply<AllOperations, true>>(target)(x.data(), y.data(), 96, pairs.data());
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_NEAR(pairs[i], halves[i], 1e-5 * (1 + std::abs(halves[i]))) << simd::name(target) << ' ' << i;
  }
}

}  // namespace
}  // namespace slalom
