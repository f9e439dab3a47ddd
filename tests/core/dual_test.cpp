#include <gtest/gtest.h>

#include <string>

#include "slalom/core/derivatives/dual_math.hpp"

namespace slalom {
namespace {

using First = Dual<double, 2>;
using Second = Dual<Dual<double, 1>, 1>;

template <class T>
T variable(double value, int direction = 0) {
  T x(value);
  x.derivative[direction] = 1;
  return x;
}

/// Compares value, first and second derivative of f at x with those of f in double.
template <class F>
void expect_derivatives(const std::string& name, F f, double x, double scale = 1) {
  const double h = 1e-4 * scale;
  const double low = f(x - h), middle = f(x), high = f(x + h);
  const First first = f(variable<First>(x, 1));
  EXPECT_DOUBLE_EQ(first.value, middle) << name << " at " << x;
  EXPECT_EQ(first.derivative[0], 0) << name;
  const double slope = (high - low) / (2 * h), curvature = (high - 2 * middle + low) / (h * h);
  EXPECT_NEAR(first.derivative[1], slope, 2e-6 * (1 + std::abs(slope))) << name << " at " << x;
  EXPECT_FALSE(first.kink) << name << " at " << x;
  Second second(x);
  second.value.derivative[0] = 1;
  second.derivative[0] = 1;
  const Second of = f(second);
  EXPECT_NEAR(of.derivative[0].derivative[0], curvature, 2e-5 * (1 + std::abs(curvature)))
      << name << " at " << x;
  EXPECT_DOUBLE_EQ(of.value.derivative[0], first.derivative[1]) << name;
}

#define SLALOM_EXPECT(expression, ...)          \
  for (const double at : {__VA_ARGS__})         \
  expect_derivatives(                           \
      #expression,                              \
      [](auto x) -> decltype(x) {               \
        using T [[maybe_unused]] = decltype(x); \
        return expression;                      \
      },                                        \
      at)

TEST(Dual, FunctionsOfOneNumberHaveTheirDerivatives) {
  SLALOM_EXPECT(sin(x), -4.0, 0.0, 0.3, 2.5);
  SLALOM_EXPECT(cos(x), -4.0, 0.0, 0.3, 2.5);
  SLALOM_EXPECT(tan(x), -1.0, 0.0, 1.2);
  SLALOM_EXPECT(exp(x), -3.0, 0.0, 2.0);
  SLALOM_EXPECT(exp2(x), -3.0, 0.0, 2.0);
  SLALOM_EXPECT(log(x), 0.2, 1.0, 7.0);
  SLALOM_EXPECT(log1p(x), -0.5, 0.0, 7.0);
  SLALOM_EXPECT(sqrt(x), 0.2, 1.0, 7.0);
  SLALOM_EXPECT(reciprocal_sqrt(x), 0.2, 1.0, 7.0);
  SLALOM_EXPECT(cbrt(x), -2.0, 0.2, 1.0);
  SLALOM_EXPECT(atan(x), -3.0, 0.0, 0.5);
  SLALOM_EXPECT(asin(x), -0.9, 0.0, 0.5);
  SLALOM_EXPECT(acos(x), -0.9, 0.0, 0.5);
  SLALOM_EXPECT(sinh(x), -2.0, 0.0, 1.0);
  SLALOM_EXPECT(cosh(x), -2.0, 0.0, 1.0);
  SLALOM_EXPECT(tanh(x), -2.0, 0.0, 1.0);
  SLALOM_EXPECT(abs(x), -2.0, 1.0);
  SLALOM_EXPECT(square(x), -2.0, 0.0, 1.0);
  SLALOM_EXPECT(wrap_angle(x), -4.0, 0.5, 7.0);
  SLALOM_EXPECT(T(3) + x * floor(x) + ceil(x) + round(x) + sign(x), -1.3, 0.2, 2.7);
}

TEST(Dual, FunctionsOfTwoNumbersHaveTheirDerivatives) {
  SLALOM_EXPECT(T(2) * x - x * x / (T(1) + x * x) + 0.5 * x - x / 3, -2.0, 0.0, 1.5);
  SLALOM_EXPECT(hypot(x, T(1) - x * x), -2.0, 0.0, 1.0);
  SLALOM_EXPECT(atan2(x, T(1) - x * x), -2.0, 0.5, 1.0);
  SLALOM_EXPECT(pow(x, T(2.5)), 0.5, 1.0, 3.0);
  SLALOM_EXPECT(pow(T(2), x), -1.0, 0.0, 3.0);
  SLALOM_EXPECT(pow(x, x), 0.5, 1.0, 3.0);
  SLALOM_EXPECT(pow(x, T(2)) + pow(x, T(0)), -2.0, 0.5, 3.0);
  SLALOM_EXPECT(min(x, x * x), -1.0, 0.5, 3.0);
  SLALOM_EXPECT(max(x, x * x), -1.0, 0.5, 3.0);
  SLALOM_EXPECT(clamp(x * x, T(1), T(4)), 0.5, 1.5, 3.0);
  SLALOM_EXPECT(fmod(x * x, T(1.5)), 0.5, 2.0, 3.1);
  SLALOM_EXPECT(fmod(T(7), x), 2.0, 3.0);
  SLALOM_EXPECT(copysign(x * x, x), -2.0, 3.0);
  SLALOM_EXPECT(fma(x, x, x) + lerp(x, T(2), x), -2.0, 0.0, 3.0);
  SLALOM_EXPECT(select((x > T(0)) && !(x > T(2)), x * x, T(3) * x), -1.0, 1.0, 3.0);
  SLALOM_EXPECT(select((x <= T(0)) || (x == T(1)), x * x, T(3) * x), -1.0, 2.0, 3.0);
}

TEST(Dual, SineAndCosineTogether) {
  First s, c;
  sin_cos(variable<First>(0.4), s, c);
  EXPECT_DOUBLE_EQ(s.derivative[0], std::cos(0.4));
  EXPECT_DOUBLE_EQ(c.derivative[0], -std::sin(0.4));
  sin_cos_half_turn(variable<First>(0.4), s, c);
  EXPECT_DOUBLE_EQ(s.value, std::sin(0.4));
}

/// Value, derivative and kink of a function of one variable.
struct At {
  double value, slope;
  bool kink;
  bool operator==(const At&) const = default;
};
template <class F>
At at(F f, double x) {
  const First r = f(variable<First>(x));
  return {r.value, r.derivative[0], r.kink};
}

TEST(Dual, KinksHaveAnAgreedDerivativeAndAreTold) {
  using T = First;
  EXPECT_EQ(at([](T x) { return abs(x); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return sqrt(x); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return sqrt(x * x); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return cbrt(x); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return hypot(x, T(0)); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return atan2(x, T(0)); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return asin(x); }, 1), (At{std::asin(1.0), 0, true}));
  EXPECT_EQ(at([](T x) { return acos(x); }, -1), (At{std::acos(-1.0), 0, true}));
  EXPECT_EQ(at([](T x) { return pow(x, T(0.5)); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return min(x, T(1)); }, 1), (At{1, 0, true}));
  EXPECT_EQ(at([](T x) { return max(T(1), x); }, 1), (At{1, 1, true}));
  EXPECT_EQ(at([](T x) { return floor(x); }, 2), (At{2, 0, true}));
  EXPECT_EQ(at([](T x) { return round(x); }, 2.5), (At{2, 0, true}));
  EXPECT_EQ(at([](T x) { return sign(x); }, 0), (At{0, 0, true}));
  EXPECT_EQ(at([](T x) { return fmod(x, T(1)); }, 2), (At{0, 1, true}));
  EXPECT_EQ(at([](T x) { return copysign(T(2), x); }, 0), (At{2, 0, true}));
  EXPECT_EQ(at([](T x) { return select(x < T(3), x, T(5)); }, 3), (At{5, 0, true}));
  EXPECT_EQ(at([](T x) { return T(2) * abs(x) + sin(x); }, 0), (At{0, 1, true})) << "kinks are passed on";
}

TEST(Dual, WhatIsSmoothIsNotToldAsAKink) {
  using T = First;
  EXPECT_EQ(at([](T x) { return x + abs(T(0)) + min(T(1), T(1)) + floor(T(2)); }, 3), (At{6, 1, false}));
  EXPECT_EQ(at([](T x) { return select(x < T(3), x, x); }, 3), (At{3, 1, false}));
  EXPECT_EQ(at([](T x) { return clamp(x, T(-1), T(1)); }, 0), (At{0, 1, false}));
  EXPECT_EQ(at([](T x) { return pow(x, T(2)); }, 0), (At{0, 0, false}));
  EXPECT_EQ(at([](T x) { return fmod(x, T(1)); }, 0), (At{0, 1, false}));
  EXPECT_EQ(at([](T x) { return select(x > T(2), T(100), T(0)); }, 1), (At{0, 0, false}));
}

TEST(Dual, CellsOfAGridAreConstant) {
  float cells[4 * 4] = {};
  cells[5] = 7;
  const GridView<1> grid(cells, 2, 2, 2, 1, 0, 0);
  const First value = look_up(grid, variable<First>(0.5), variable<First>(0.5));
  EXPECT_EQ(value.value, 7);
  EXPECT_EQ(value.derivative[0], 0);
}

}  // namespace
}  // namespace slalom
