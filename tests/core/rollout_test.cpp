#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "slalom/core/grid_view.hpp"
#include "slalom/core/problem_evaluator.hpp"

namespace slalom {
namespace {

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
        float* cell = &cells[static_cast<std::size_t>(4 * (i * 64 + j))];
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

class RolloutOn : public ::testing::TestWithParam<simd::Target> {};

TEST_P(RolloutOn, AgreesWithDouble) {
  if (!simd::supported(GetParam())) GTEST_SKIP() << "this processor has no " << simd::name(GetParam());
  Fixture f;
  ProblemEvaluator<Unicycle> evaluator(f.problem, GetParam());
  const Unicycle::State<double> start{0.513, -0.271, 0.4};
  evaluator.set_state(start);
  std::vector<float> costs(padded(300));
  std::vector<std::uint8_t> collided(padded(300));
  evaluator.evaluate(f.batch, 0, 300, costs.data(), collided.data());
  int different_cells = 0, collisions = 0;
  for (int k = 0; k < 300; ++k) {
    Input<double, 2> u[12];
    for (int t = 0; t < 12; ++t) u[t] = {{f.batch.at(t, 0, k), f.batch.at(t, 1, k)}};
    const Cost<double> exact = predict(f.problem, start, u, 12, nullptr);
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
  if (!simd::supported(GetParam())) GTEST_SKIP() << "this processor has no " << simd::name(GetParam());
  Fixture f;
  ProblemEvaluator<Unicycle> alone(f.problem, GetParam());
  ProblemEvaluator<LongUnicycle> pairs({f.problem}, GetParam());
  static_assert(detail::has_long_steps<LongUnicycle> && !detail::has_long_steps<Unicycle>);
  alone.set_state({0.513, -0.271, 0.4});
  pairs.set_state({0.513, -0.271, 0.4});
  std::vector<float> expected(padded(300));
  std::vector<std::uint8_t> expected_hits(padded(300));
  alone.evaluate(f.batch, 0, 300, expected.data(), expected_hits.data());
  // Every number of packs, an odd one too, and the ends of the batch.
  for (const int first : {0, 16, 208})
    for (const int count : {1, 16, 17, 32, 40, 48, 92}) {
      std::vector<float> costs(padded(300), -1.0f);
      std::vector<std::uint8_t> hits(padded(300), 9);
      pairs.evaluate(f.batch, first, count, costs.data(), hits.data());
      const auto at = static_cast<std::size_t>(first), end = static_cast<std::size_t>(first + count);
      for (std::size_t k = at; k < end; ++k) {
        EXPECT_NEAR(costs[k], expected[k], 1e-5 * expected[k]) << first << " + " << count << ": " << k;
        EXPECT_EQ(hits[k], expected_hits[k]) << first << " + " << count << ": " << k;
      }
      for (std::size_t k = 0; k < costs.size(); ++k)
        if (k < at || k >= static_cast<std::size_t>(padded(first + count))) {
          EXPECT_EQ(costs[k], -1.0f) << k << " was not asked for";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Targets, RolloutOn,
                         ::testing::Values(simd::Target::generic, simd::Target::sse4, simd::Target::avx2,
                                           simd::Target::avx512),
                         [](const auto& target) { return simd::name(target.param); });

TEST(Rollout, PositionsThatAreNotFiniteCountAsOutside) {
  Fixture f;
  ProblemEvaluator<Unicycle> evaluator(f.problem);
  for (int t = 0; t < 12; ++t) f.batch.at(t, 0, 5) = std::nanf("");
  for (int t = 0; t < 12; ++t) f.batch.at(t, 0, 6) = 1e30f;
  evaluator.set_state({0.513, -0.271, 0.4});
  std::vector<float> costs(padded(300));
  std::vector<std::uint8_t> collided(padded(300));
  evaluator.evaluate(f.batch, 0, 300, costs.data(), collided.data());
  EXPECT_EQ(collided[5], 1);
  EXPECT_EQ(collided[6], 1);
}

TEST(GridView, UpperEdgeIsInsideLowerEdgeOutside) {
  std::vector<float> cells(4 * 8, 9.0f);
  for (int i = 1; i <= 2; ++i)
    for (int j = 1; j <= 2; ++j) cells[static_cast<std::size_t>(i * 8 + j)] = static_cast<float>(10 * i + j);
  const GridView<1> grid(cells.data(), 2, 2, 3, 1.0, 0.0, 0.0);
  EXPECT_EQ(look_up(grid, 0.5, 0.5), 11);
  EXPECT_EQ(look_up(grid, -0.5, 0.5), 21);
  EXPECT_EQ(look_up(grid, 0.5, -0.5), 12);
  EXPECT_EQ(look_up(grid, 1.0, 0.5), 11);
  EXPECT_EQ(look_up(grid, -1.0, 0.5), 9);
  EXPECT_EQ(look_up(grid, 1.0001, 0.5), 9);
}

}  // namespace
}  // namespace slalom
