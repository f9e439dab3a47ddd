#include "slalom/solvers/ilqr.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/slalom.hpp"
#include "solvers/problems.hpp"
#include "support/allocations.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

using testing::DoubleIntegrator;
constexpr int steps = 20;

double cost_of(const auto& problem, const auto& x, std::span<const Input<double, 1>> u) {
  return predict(problem, x, u.data(), static_cast<int>(u.size()), nullptr).value;
}

TEST(Ilqr, OneStepSolvesALinearQuadraticProblem) {
  const DoubleIntegrator problem;
  const DoubleIntegrator::State<double> start{1, -0.5};
  Ilqr ilqr{problem, steps, {.iterations = 1}};
  const auto u = ilqr.improve(problem, start);
  const std::vector<double> best = problem.optimum(start, steps);
  ASSERT_EQ(u.size(), best.size());
  for (std::size_t k = 0; k < best.size(); ++k) EXPECT_NEAR(u[k][0], best[k], 1e-8) << k;
  EXPECT_EQ(ilqr.result().iterations(), 1);
  EXPECT_NEAR(ilqr.result().cost(), cost_of(problem, start, u), 1e-12);
  EXPECT_FALSE(ilqr.result().has_kink());
  ilqr.improve(problem, start);
  EXPECT_EQ(ilqr.result().iterations(), 0) << "there is nothing left to gain";
}

/// The cart-pole hangs down; its force is limited.
const problems::CartPole::State<double> hanging{0, 0, 3.0, 0};

template <class P>
struct Limited : P {
  double input_min = -1, input_max = 1;
};

TEST(Ilqr, TheCostOfANonlinearProblemFallsWithEveryStep) {
  const problems::CartPole problem;
  Ilqr ilqr{problem, 60, {.iterations = 1}};
  double last = cost_of(problem, hanging, std::vector<Input<double, 1>>(60, Input<double, 1>{}));
  const double first = last;
  int fell = 0;
  for (int i = 0; i < 40; ++i) {
    const auto u = ilqr.improve(problem, hanging);
    const double cost = cost_of(problem, hanging, u);
    EXPECT_NEAR(ilqr.result().cost(), cost, 1e-9 * (1 + cost));
    EXPECT_NEAR(ilqr.result().first_cost(), last, 1e-9 * (1 + last));
    EXPECT_LE(cost, last);
    fell += cost < last;
    last = cost;
  }
  EXPECT_GE(fell, 5);
  EXPECT_LT(last, 0.8 * first);
}

TEST(Ilqr, InputsThatTheirBoundsHoldSatisfyTheConditionsOfAnOptimum) {
  const Limited<DoubleIntegrator> problem;
  const DoubleIntegrator::State<double> start{3, 0};
  Ilqr ilqr{problem, steps, {.iterations = 30}};
  const auto found = ilqr.improve(problem, start);
  std::vector<Input<double, 1>> u(found.begin(), found.end());
  int held = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    ASSERT_LE(std::abs(u[k][0]), 1.0);
    const double value = u[k][0], h = 1e-4;
    u[k][0] = value + h;
    const double up = cost_of(problem, start, u);
    u[k][0] = value - h;
    const double slope = (up - cost_of(problem, start, u)) / (2 * h);
    u[k][0] = value;
    if (std::abs(value) < 1) {
      EXPECT_NEAR(slope, 0, 1e-5) << k;
    } else {
      EXPECT_LT(slope * value, 1e-5) << k << ": the cost would fall beyond the bound";
      ++held;
    }
  }
  EXPECT_GT(held, 3);
  EXPECT_LT(held, steps);
}

TEST(Ilqr, ContinuesFromItsSequenceMovedForward) {
  const DoubleIntegrator problem;
  Ilqr ilqr{problem, steps, {.iterations = 1}};
  const std::vector<Input<double, 1>> ramp{{{0.1}}, {{0.2}}, {{0.4}}};
  ilqr.start_from(ramp);
  const auto sequence = [](double shift) {
    std::vector<Input<double, 1>> u;
    for (int k = 0; k < steps; ++k) {
      const double at = std::min(k + shift, 2.0);
      u.push_back({{at < 1 ? 0.1 + 0.1 * at : 0.2 * at}});
    }
    return u;
  };
  ilqr.improve(problem, {1, 0}, 0.15);  // one step and a half
  EXPECT_NEAR(ilqr.result().first_cost(),
              cost_of(problem, DoubleIntegrator::State<double>{1, 0}, sequence(1.5)), 1e-9);
  ilqr.start_from({});
  ilqr.improve(problem, {1, 0});
  EXPECT_NEAR(ilqr.result().first_cost(),
              cost_of(problem, DoubleIntegrator::State<double>{1, 0},
                      std::vector<Input<double, 1>>(steps, Input<double, 1>{})),
              1e-9);
}

/// A state and two inputs, whose cost is never finite: `improve` returns the sequence it starts from.
struct WithoutCost final : DifferentiableProblem {
  void step(int, std::span<const double> x, std::span<const double>, std::span<double> next) override {
    next[0] = x[0];
  }
  double cost(std::span<const double>, std::span<const double>) override {
    return std::numeric_limits<double>::infinity();
  }
  bool expand_step(int, const FeedbackGains::Step&) override { return false; }
  bool expand_end(const FeedbackGains::Terminal&) override { return false; }
};

TEST(IterativeLqr, ValuesBeyondTheLastWholeStepAreNotUsed) {
  IterativeLqr lqr(1, 2, 3, InputBounds(2));
  WithoutCost problem;
  const auto started_from = [&](const std::vector<double>& values) {
    lqr.start_from(values);
    const auto inputs = lqr.improve(problem, std::vector<double>{0});
    return std::vector<double>(inputs.begin(), inputs.end());
  };
  EXPECT_EQ(started_from({1, 2, 3, 4, 5}), (std::vector<double>{1, 2, 3, 4, 3, 4}));
  EXPECT_EQ(started_from({1, 2, 3}), (std::vector<double>{1, 2, 1, 2, 1, 2}));
  EXPECT_EQ(started_from({1}), (std::vector<double>(6)));
}

TEST(Ilqr, ByItselfItSwingsThePendulumUp) {
  Limited<problems::Pendulum> problem;
  problem.input_min = -5;
  problem.input_max = 5;
  Ilqr ilqr{problem, 60};
  problems::Pendulum::State<double> x{3.1, 0};
  for (int k = 0; k < 300; ++k) x = problem.step(x, ilqr.improve(problem, x, problem.dt)[0]);
  EXPECT_GT(std::cos(x.angle), 0.99);
}

/// Costs for tests of what has no derivative.
struct OddCost {
  template <class T>
  struct State {
    T x;
  };
  static constexpr int inputs = 1;
  bool broken = false, bent = false, indifferent = false;
  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    return {s.x + T(indifferent ? 0 : 0.1) * u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    if (indifferent) return square(s.x - T(1));
    const T jump = select(s.x > T(0.5), T(100), T(0));
    return square(s.x - T(1)) + T(0.01) * u[0] * u[0] + jump + (bent ? abs(s.x - s.x * T(2)) : T(0)) +
           (broken ? log(abs(s.x) - abs(s.x)) : T(0));
  }
  template <class T>
  T terminal_cost(const State<T>&) const {
    return T(0);
  }
};

TEST(Ilqr, NeverPaysForAJumpOfTheCost) {
  const OddCost problem;
  Ilqr ilqr{problem, 8};
  const auto u = ilqr.improve(problem, {0});
  EXPECT_LE(ilqr.result().cost(), ilqr.result().first_cost());
  double x = 0;
  for (const auto& input : u) {
    EXPECT_LE(x, 0.5) << "the jump is at 0.5, the smooth costs lead beyond it";
    x += 0.1 * input[0];
  }
}

TEST(Ilqr, WhatHasNoDerivativeIsToldAndNeverHarms) {
  OddCost problem;
  problem.bent = true;
  Ilqr ilqr{problem, 8};
  ilqr.improve(problem, {0});
  EXPECT_TRUE(ilqr.result().has_kink());
  problem.broken = true;
  const std::vector<Input<double, 1>> before{{{0.25}}};
  ilqr.start_from(before);
  for (const auto& u : ilqr.improve(problem, {0})) EXPECT_EQ(u[0], 0.25);
  EXPECT_EQ(ilqr.result().iterations(), 0);
  problem = {};
  problem.indifferent = true;
  ilqr.start_from(before);
  for (const auto& u : ilqr.improve(problem, {0})) EXPECT_EQ(u[0], 0.25);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Input<double, 1>> values{{{nan}}, {{std::numeric_limits<double>::infinity()}}};
  ilqr.start_from(values);
  for (const auto& u : ilqr.improve(problem, {nan})) EXPECT_EQ(u[0], 0);
}

TEST(Ilqr, AsAProposalItImprovesThePlansOfEveryMethodThatTakesProposals) {
  const Limited<problems::CartPole> problem{{}, -10, 10};
  for (const char* method : {"mppi", "svg_mppi", "cem", "icem", "dial_mpc"}) {
    SolverOptions options = solver_options(method);
    *options.find<int>("horizon") = 60;
    *options.find<int>("samples") = 32;
    Controller<Limited<problems::CartPole>> alone(problem, options), helped(problem, options);
    Ilqr ilqr{helped, {.iterations = 20}};
    Proposals proposals{helped, 1};
    proposals.add(ilqr.improve(problem, hanging));
    const double without = alone.solve(hanging).cost;
    EXPECT_LT(helped.solve(hanging, {.proposals = proposals}).cost, without) << method;
  }
}

TEST(Ilqr, AllocatesNothingAfterConstruction) {
  SvgMppi controller{problems::CartPole{}, {.horizon = 20, .input_min = {-10}, .input_max = {10}}};
  Proposals proposals{controller, 1};
  Ilqr ilqr{controller};
  const long before = testing::allocations();
  ASSERT_GT(before, 0) << "nothing is counted";
  for (int i = 0; i < 3; ++i) {
    proposals.clear();
    proposals.add(ilqr.improve(controller.problem(), hanging, 0.02));
    ilqr.start_from(controller.solve(hanging, {.elapsed = 0.02, .proposals = proposals}).inputs);
  }
  EXPECT_EQ(testing::allocations(), before);
}

TEST(Ilqr, MistakesNameTheRule) {
  EXPECT_EQ(message_of([] { Ilqr(DoubleIntegrator{}, 0); }),
            "feedback: number of steps: 0 must be at least 1");
  EXPECT_EQ(message_of([] {
              Ilqr{DoubleIntegrator{}, 5, {.iterations = 0}};
            }),
            "ilqr.iterations: 0 must be in [1, 1000]");
}

}  // namespace
}  // namespace slalom
