#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "slalom/solvers/dial_mpc_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/registry.hpp"
#include "solvers/problems.hpp"

/// Differences between `dial_mpc` and `mppi`; solver_contract_test.cpp tests every method.
namespace slalom {
namespace {

/// A wide bowl with a narrow one of equal depth in it: its minimum is at 1 in every step.
auto bowl() {
  return testing::sum_over_steps(
      [](double u, int) { return (u - 1) * (u - 1) - std::exp(-200 * (u - 1) * (u - 1)); });
}

TEST(DialMpc, UpdatesMoreOftenInTheFirstSolve) {
  const auto evaluator = bowl();
  const auto solver = make_solver(DialMpcOptions{.samples = 20, .iterations = 3, .first_iterations = 7}, 1);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 7);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 3);
  solver->reset(1);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 7);
  const auto broken = testing::sum_over_steps([](double, int) { return std::nan(""); });
  solver->reset(1);
  EXPECT_EQ(solver->solve(broken, {}).iterations, 0);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 7) << "there is still no solution";
}

TEST(DialMpc, NoiseShrinksOverUpdatesAndTowardsTheStart) {
  constexpr int steps = 5;
  const auto flat = testing::sum_over_steps([](double, int) { return 0.0; });
  for (const int iterations : {1, 3}) {
    const auto solver = make_solver(DialMpcOptions{.horizon = steps,
                                                   .samples = 80000,
                                                   .variance = 4,
                                                   .first_iterations = iterations,
                                                   .iteration_decay = 0.6,
                                                   .horizon_decay = 0.4},
                                    1);
    const SolveResult& result = solver->solve(flat, {});
    const int samples = result.samples->samples();
    for (int t = 0; t < steps; ++t) {
      const double deviation = 2 * std::pow(0.6, iterations - 1) * std::pow(0.4, 1 - t / (steps - 1.0));
      double squares = 0, sum = 0;
      for (int k = 0; k < samples; ++k) {
        const auto v = static_cast<double>(result.samples->at(t, 0, k));
        squares += v * v;
        sum += v;
      }
      const double mean = sum / samples;
      EXPECT_NEAR(std::sqrt(squares / samples - mean * mean) / deviation, 1, 0.02) << t;
      EXPECT_NEAR(result.variances[t], deviation * deviation, 1e-5) << t;
    }
  }
}

TEST(DialMpc, WithOneUpdateAndEvenNoiseItIsMppiWithoutControlTerm) {
  const auto evaluator = bowl();
  const auto expected = make_solver(MppiOptions{.control_cost_discount = 1}, 1);
  const auto solver = make_solver(
      DialMpcOptions{.samples = 1024, .iterations = 1, .first_iterations = 1, .horizon_decay = 1}, 1);
  for (int i = 0; i < 3; ++i) {
    const SolveRequest request{.elapsed = 0.05};
    const SolveResult &a = solver->solve(evaluator, request), &b = expected->solve(evaluator, request);
    EXPECT_TRUE(std::equal(a.inputs.begin(), a.inputs.end(), b.inputs.begin())) << i;
  }
}

}  // namespace
}  // namespace slalom
