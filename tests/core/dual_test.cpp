#include <gtest/gtest.h>

#include <random>
#include <string>

#include "slalom/core/derivatives/dual_math.hpp"
#include "slalom/core/grid_view.hpp"
#include "support/rollouts.hpp"

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

/// A unicycle over a map: uses everything a problem may (two inputs, a look-up, the step index, a collision).
struct Unicycle {
  template <class T>
  struct State {
    T x, y, yaw;
  };
  static constexpr int inputs = 2;  // speed, yaw rate
  GridView<4> map;

  template <class T>
  CellValues<T> look_up(const State<T>& s) const {
    return slalom::look_up(map, s.x, s.y);
  }
  template <class T>
  State<T> step(const State<T>& s, const CellValues<T>&, const Input<T, 2>& u, int k) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    const T dt = k < 2 ? T(0.1) : T(0.05);
    return {s.x + dt * u[0] * cosine, s.y + dt * u[0] * sine, s.yaw + dt * u[1]};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const CellValues<T>& seen, const Input<T, 2>& u) const {
    return {seen.a + square(wrap_angle(s.yaw - seen.b)) + T(0.1) * u[1] * u[1], seen.c > T(0.5)};
  }
  template <class T>
  Cost<T> terminal_cost(const State<T>&, const CellValues<T>& seen) const {
    return {T(3) * seen.a, seen.c > T(0.5)};
  }
};

struct Fixture {
  static constexpr int n = 40;
  std::vector<float> cells = std::vector<float>(4 * (n + 2) * 64);
  Unicycle problem;
  SequenceBatch batch{12, 2, 300};

  Fixture() {
    for (int i = 0; i < n + 2; ++i)
      for (int j = 0; j < 64; ++j) {
        float* cell = &cells[4 * (i * 64 + j)];
        const bool outside = i == 0 || j == 0 || i == n + 1 || j >= n + 1;
        cell[0] = outside ? 50.0f : 0.1f * static_cast<float>(i % 7 + j % 5);
        cell[1] = 0.3f * static_cast<float>((i * j) % 11);
        cell[2] = outside || (i * 7 + j) % 13 == 0 ? 1.0f : 0.0f;
      }
    problem.map = GridView<4>(cells.data(), n, n, 6, 0.1, 0.5, -0.25);
    std::mt19937 generator(3);
    std::normal_distribution<float> normal(0, 2);
    for (int t = 0; t < 12; ++t)
      for (int k = 0; k < 300; ++k) {
        batch.at(t, 0, k) = 2 + normal(generator);
        batch.at(t, 1, k) = normal(generator);
      }
  }
};

class RolloutOn : public testing::OnInstructionSet {};
SLALOM_ON_EVERY_INSTRUCTION_SET(RolloutOn);

TEST_P(RolloutOn, AgreesWithDouble) {
  Fixture f;
  ProblemEvaluator<Unicycle> evaluator(f.problem, GetParam());
  const Unicycle::State<double> start{0.513, -0.271, 0.4};
  evaluator.set_state(start);
  const auto [costs, collided] = testing::roll_out(evaluator, f.batch);
  int different_cells = 0, collisions = 0;
  for (int k = 0; k < 300; ++k) {
    const auto u = testing::inputs_of<2>(f.batch, k);
    const Cost<double> exact = predict(f.problem, start, u.data(), 12, nullptr);
    if (std::abs(costs[k] - exact.value) > 1e-4 * std::max(1.0, exact.value)) {
      ++different_cells;  // a position within rounding of a cell's edge
    } else {
      EXPECT_EQ(collided[k] != 0, exact.collided);
    }
    collisions += exact.collided;
  }
  EXPECT_LE(different_cells, 2);
  EXPECT_GT(collisions, 30);
  EXPECT_LT(collisions, 299);
}

/// The same problem, whose rollouts take packs in pairs.
struct LongUnicycle : Unicycle {
  static constexpr bool long_steps = true;
};

TEST_P(RolloutOn, TakesPacksInPairsWithTheSameResults) {
  Fixture f;
  ProblemEvaluator<Unicycle> alone(f.problem, GetParam());
  ProblemEvaluator<LongUnicycle> pairs({f.problem}, GetParam());
  static_assert(detail::has_long_steps<LongUnicycle> && !detail::has_long_steps<Unicycle>);
  alone.set_state({0.513, -0.271, 0.4});
  pairs.set_state({0.513, -0.271, 0.4});
  const auto [expected, expected_hits] = testing::roll_out(alone, f.batch);
  // Every number of packs, an odd one too, and the ends of the batch.
  for (const int first : {0, 16, 208})
    for (const int count : {1, 16, 17, 32, 40, 48, 92}) {
      std::vector<float> costs(padded(300), -1.0f);
      std::vector<std::uint8_t> hits(padded(300), 9);
      pairs.evaluate(f.batch, first, count, costs.data(), hits.data());
      for (int k = first; k < first + count; ++k) {
        EXPECT_NEAR(costs[k], expected[k], 1e-5 * expected[k]) << first << " + " << count << ": " << k;
        EXPECT_EQ(hits[k], expected_hits[k]) << first << " + " << count << ": " << k;
      }
      for (int k = 0; k < padded(300); ++k)
        if (k < first || k >= padded(first + count)) {
          EXPECT_EQ(costs[k], -1.0f) << k << " was not asked for";
        }
    }
}

TEST(Rollout, PositionsThatAreNotFiniteCountAsOutside) {
  Fixture f;
  ProblemEvaluator<Unicycle> evaluator(f.problem);
  for (int t = 0; t < 12; ++t) f.batch.at(t, 0, 5) = std::nanf("");
  for (int t = 0; t < 12; ++t) f.batch.at(t, 0, 6) = 1e30f;
  evaluator.set_state({0.513, -0.271, 0.4});
  const auto collided = testing::roll_out(evaluator, f.batch).collided;
  EXPECT_EQ(collided[5], 1);
  EXPECT_EQ(collided[6], 1);
}

TEST(GridView, UpperEdgeIsInsideLowerEdgeOutside) {
  std::vector<float> cells(4 * 8, 9.0f);
  for (int i = 1; i <= 2; ++i)
    for (int j = 1; j <= 2; ++j) cells[i * 8 + j] = static_cast<float>(10 * i + j);
  const GridView<1> grid(cells.data(), 2, 2, 3, 1.0, 0.0, 0.0);
  EXPECT_EQ(look_up(grid, 0.5, 0.5), 11);
  EXPECT_EQ(look_up(grid, -0.5, 0.5), 21);
  EXPECT_EQ(look_up(grid, 0.5, -0.5), 12);
  EXPECT_EQ(look_up(grid, 1.0, 0.5), 11);
  EXPECT_EQ(look_up(grid, -1.0, 0.5), 9);
  EXPECT_EQ(look_up(grid, 1.0001, 0.5), 9);
}

TEST(AlignedBuffer, IsZeroedAndAligned) {
  const AlignedBuffer buffer(37);
  EXPECT_EQ(buffer.size(), 37);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % 64, 0u);
  for (int i = 0; i < 37; ++i) EXPECT_EQ(buffer[i], 0.0f);
}

TEST(SequenceBatch, RowsAreStepsTimesInputs) {
  SequenceBatch batch(3, 2, 5);
  EXPECT_EQ(batch.rows(), 6);
  EXPECT_EQ(batch.stride(), simd::padding);
  batch.at(2, 1, 4) = 7;
  EXPECT_EQ(batch[5][4], 7.0f);
  EXPECT_EQ(batch.data(5), batch.row(2, 1));
  EXPECT_EQ(batch.data(5) - batch.data(4), batch.stride());
}

TEST(SequenceBatch, SamplesAreCopiedInAndOut) {
  SequenceBatch batch(2, 2, 20);
  const std::array<float, 4> sequence{1, 2, 3, 4};
  batch.set_sample(17, sequence);
  EXPECT_EQ(batch.at(0, 0, 17), 1.0f);
  EXPECT_EQ(batch.at(1, 1, 17), 4.0f);
  EXPECT_EQ(batch.at(1, 1, 16), 0.0f);
  EXPECT_EQ(batch.at(1, 1, 18), 0.0f);
  std::array<float, 4> copy{};
  batch.get_sample(17, copy);
  EXPECT_EQ(copy, sequence);
}

}  // namespace

}  // namespace slalom
