// The optional members of a problem, in the rollouts of every instruction set.

#include "support/rollouts.hpp"

namespace slalom {
namespace {

/// A point pushed along a line, its cost in one piece.
struct Plain {
  template <class T>
  struct State {
    T position, speed;
  };
  static constexpr int inputs = 2;  // two pushes
  double dt = 0.1;

  template <class T>
  State<T> step(const State<T>& x, const Input<T, 2>& u) const {
    return {x.position + T(dt) * x.speed, x.speed + T(dt) * (u[0] + u[1])};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 2>& u) const {
    return {square(x.position) + T(0.1) * square(x.speed) + T(0.01) * (square(u[0]) + square(u[1])),
            abs(x.position) > T(1)};
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(10) * square(x.position);
  }
};

/// The same without a terminal cost.
struct Unending {
  template <class T>
  using State = Plain::State<T>;
  static constexpr int inputs = Plain::inputs;

  template <class T>
  State<T> step(const State<T>& x, const Input<T, 2>& u) const {
    return Plain{}.step(x, u);
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 2>& u) const {
    return Plain{}.stage_cost(x, u);
  }
};

/// The same in terms.
struct Named : Plain {
  static constexpr std::array cost_names{"position", "speed", "effort"};

  template <class T>
  CostTerms<T, 3> stage_cost(const State<T>& x, const Input<T, 2>& u) const {
    return {{square(x.position), T(0.1) * square(x.speed), T(0.01) * (square(u[0]) + square(u[1]))},
            abs(x.position) > T(1)};
  }
};

/// All of it in terms: the end of the way counts as position.
struct AllNamed : Named {
  template <class T>
  CostTerms<T, 3> terminal_cost(const State<T>& x) const {
    return {{T(10) * square(x.position), T(0), T(0)}};
  }
};

/// Pushes that build up slowly: the first by 2 a second, the second by 0.5.
struct Slow : Plain {
  std::array<double, 2> input_rate_max{2, 0.5};
};

/// A push that is on, off or reversed, and one of any value.
struct Stepped : Plain {
  double input_min = -1, input_max = 1;
  std::array<double, 2> input_levels{3, 0};
};

SequenceBatch some_inputs() {
  SequenceBatch batch(9, 2, 128);
  fill_normal(batch, 0, 128, {3, 1});
  return batch;
}

class ProblemPartsOnInstructionSet : public testing::OnInstructionSet {};
SLALOM_ON_EVERY_INSTRUCTION_SET(ProblemPartsOnInstructionSet);

TEST_P(ProblemPartsOnInstructionSet, TermsSumToTheSameCost) {
  ProblemEvaluator<Plain> one({}, GetParam());
  ProblemEvaluator<Named> other({}, GetParam());
  one.set_state({0.9, 0.3});
  other.set_state({0.9, 0.3});
  const auto plain = testing::roll_out(one, some_inputs()), named = testing::roll_out(other, some_inputs());
  int collisions = 0;
  for (std::size_t k = 0; k < 128; ++k) {
    EXPECT_NEAR(plain.costs[k], named.costs[k], 1e-5f * plain.costs[k]);
    EXPECT_EQ(plain.collided[k], named.collided[k]);
    collisions += named.collided[k];
  }
  EXPECT_GT(collisions, 10);
  EXPECT_LT(collisions, 120);
}

TEST_P(ProblemPartsOnInstructionSet, RateLimitsHoldInRolloutsAsInThePlan) {
  ProblemEvaluator<Slow> evaluator({}, GetParam());
  const Input<double, 2> before{{0.5, -0.25}};
  evaluator.set_state({0.4, 0.1});
  evaluator.set_previous_input(before);
  const SequenceBatch batch = some_inputs();
  const auto costs = testing::roll_out(evaluator, batch).costs;
  for (int k = 0; k < 128; ++k) {
    auto u = testing::inputs_of<2>(batch, k);
    const double free = predict(Slow{}, {0.4, 0.1}, u.data(), 9, nullptr).value;
    hold_input_rates(Slow{}, before, u.data(), 9);
    const double held = predict(Slow{}, {0.4, 0.1}, u.data(), 9, nullptr).value;
    EXPECT_NEAR(costs[k], held, 1e-4 * held);
    EXPECT_NE(free, held);
  }
}

TEST_P(ProblemPartsOnInstructionSet, LevelsHoldInRolloutsAsInThePlan) {
  ProblemEvaluator<Stepped> evaluator({}, GetParam());
  const Input<double, 2> remainder{{0.25, 0}};
  evaluator.set_state({0.4, 0.1});
  evaluator.set_previous_input(remainder);
  const SequenceBatch batch = some_inputs();
  const auto costs = testing::roll_out(evaluator, batch).costs;
  for (int k = 0; k < 128; ++k) {
    auto u = testing::inputs_of<2>(batch, k);
    const auto free = u;
    hold_input_rates(Stepped{}, remainder, u.data(), 9);
    for (std::size_t step = 0; step < 9; ++step) {
      EXPECT_TRUE(u[step][0] == -1 || u[step][0] == 0 || u[step][0] == 1) << u[step][0];
      EXPECT_EQ(u[step][1], free[step][1]);
    }
    const double held = predict(Stepped{}, {0.4, 0.1}, u.data(), 9, nullptr).value;
    EXPECT_NEAR(costs[k], held, 1e-4 * held);
  }
}

TEST(ProblemParts, RatesAreHeldFromWhatWasAppliedBefore) {
  Input<double, 2> u[3] = {{{5, -5}}, {{5, -5}}, {{0.3, 0}}};
  hold_input_rates(Slow{}, {{1, 0}}, u, 3);
  EXPECT_DOUBLE_EQ(u[0][0], 1.2);
  EXPECT_DOUBLE_EQ(u[0][1], -0.05);
  EXPECT_DOUBLE_EQ(u[1][0], 1.4);
  EXPECT_DOUBLE_EQ(u[2][0], 1.2);
  EXPECT_DOUBLE_EQ(u[2][1], -0.05);
}

TEST(ProblemParts, LevelsHaveTheMeanOfTheInputs) {
  std::array<Input<double, 2>, 40> u;
  u.fill({{0.28125, 0.28125}});
  hold_input_rates(Stepped{}, {}, u.data(), 40);
  double sum = 0;
  for (const auto& each : u) sum += each[0];
  EXPECT_NEAR(sum, 40 * 0.28125, 0.5);
  Input<double, 2> remainder{};  // as if the plan was made in two parts
  const std::vector<float> wanted(80, 0.28125f);
  carry_remainder(Stepped{}, wanted.data(), u.data(), 17, remainder);
  std::array<Input<double, 2>, 23> rest;
  rest.fill({{0.28125, 0.28125}});
  hold_input_rates(Stepped{}, remainder, rest.data(), 23);
  for (std::size_t k = 0; k < 23; ++k) EXPECT_EQ(rest[k][0], u[17 + k][0]) << k;
}

TEST(ProblemParts, TheTerminalCostIsOptional) {
  const Input<double, 2> u[1] = {{{1, 2}}};
  EXPECT_EQ(predict(Unending{}, {0.5, 1}, u, 1, nullptr).value,
            Plain{}.stage_cost(Plain::State<double>{0.5, 1}, u[0]).value);
  ProblemEvaluator<Unending> evaluator{Unending{}};
  evaluator.set_state({0.5, 1});
  SequenceBatch batch(1, 2, 1);
  batch.at(0, 0, 0) = 1;
  batch.at(0, 1, 0) = 2;
  EXPECT_FLOAT_EQ(testing::roll_out(evaluator, batch).costs[0], 0.25f + 0.1f + 0.05f);
}

TEST(ProblemParts, CostTermsAreNamed) {
  const Input<double, 2> u[2] = {{{1, 2}}, {{0, 0}}};
  CostTermsOf<Plain> plain;
  CostTermsOf<Named> named;
  CostTermsOf<AllNamed> all;
  const double cost = predict(Plain{}, {0.5, 1}, u, 2, nullptr, &plain).value;
  EXPECT_DOUBLE_EQ(predict(Named{}, {0.5, 1}, u, 2, nullptr, &named).value, cost);
  EXPECT_DOUBLE_EQ(predict(AllNamed{}, {0.5, 1}, u, 2, nullptr, &all).value, cost);
  // Positions 0.5, 0.6, 0.73 and speeds 1, 1.3.
  ASSERT_EQ(plain.size(), 2u);
  EXPECT_STREQ(plain[0].name, "stage");
  EXPECT_STREQ(plain[1].name, "terminal");
  EXPECT_NEAR(plain[1].value, 10 * 0.73 * 0.73, 1e-12);
  EXPECT_NEAR(plain[0].value + plain[1].value, cost, 1e-12);
  ASSERT_EQ(named.size(), 4u);
  EXPECT_STREQ(named[0].name, "position");
  EXPECT_NEAR(named[0].value, 0.25 + 0.36, 1e-12);
  EXPECT_NEAR(named[1].value, 0.1 * (1 + 1.69), 1e-12);
  EXPECT_NEAR(named[2].value, 0.05, 1e-12);
  EXPECT_STREQ(named[3].name, "terminal");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_NEAR(all[0].value, 0.25 + 0.36 + 10 * 0.73 * 0.73, 1e-12);
}

TEST(ProblemParts, OmittedPartsTakeNoMemory) {
  EXPECT_EQ(sizeof(detail::Rollout<Plain, float>), 3 * sizeof(float) + sizeof(float));
  EXPECT_EQ(detail::start_size<Plain>, 2);
  EXPECT_EQ(detail::start_size<Slow>, 4);
  EXPECT_EQ(ProblemEvaluator<Plain>(Plain{}).sampler(), nullptr);
}

}  // namespace
}  // namespace slalom
