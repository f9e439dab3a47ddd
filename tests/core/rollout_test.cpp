
#include <random>

#include "slalom/core/grid_view.hpp"
#include "support/rollouts.hpp"

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
