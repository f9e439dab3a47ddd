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
  return testing::FunctionEvaluator(1, [](const SequenceBatch& batch, int k) {
    double cost = 0;
    for (int t = 0; t < batch.steps(); ++t) {
      const double distance = static_cast<double>(batch.at(t, 0, k)) - 1;
      cost += distance * distance - std::exp(-200 * distance * distance);
    }
    return std::pair(cost, false);
  });
}

TEST(DialMpc, UpdatesMoreOftenInTheFirstSolve) {
  const auto evaluator = bowl();
  const auto solver = make_solver(DialMpcOptions{.samples = 20, .iterations = 3, .first_iterations = 7}, 1);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 7);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 3);
  solver->reset(1);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 7);
  const auto broken =
      testing::FunctionEvaluator(1, [](const SequenceBatch&, int) { return std::pair(std::nan(""), false); });
  solver->reset(1);
  EXPECT_EQ(solver->solve(broken, {}).iterations, 0);
  EXPECT_EQ(solver->solve(evaluator, {}).iterations, 7) << "there is still no solution";
}

TEST(DialMpc, NoiseShrinksOverUpdatesAndTowardsTheStart) {
  constexpr int steps = 5, samples = 40000;
  const auto flat =
      testing::FunctionEvaluator(1, [](const SequenceBatch&, int) { return std::pair(0.0, false); });
  for (const int iterations : {1, 3}) {
    const auto solver = make_solver(DialMpcOptions{.horizon = steps,
                                                   .samples = samples,
                                                   .variance = 4,
                                                   .first_iterations = iterations,
                                                   .iteration_decay = 0.6,
                                                   .horizon_decay = 0.4},
                                    1);
    const SolveResult& result = solver->solve(flat, {});
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
      EXPECT_NEAR(result.variances[static_cast<std::size_t>(t)], deviation * deviation, 1e-5) << t;
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

/// With the same number of rollouts, shrinking noise comes closer to a narrow minimum than noise of one size.
TEST(DialMpc, AnnealingRefinesTheSolution) {
  const auto evaluator = bowl();
  const auto error = [&](double decay) {
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto solver = make_solver(DialMpcOptions{.horizon = 6,
                                                     .temperature = 0.1,
                                                     .first_iterations = 8,
                                                     .iteration_decay = decay,
                                                     .horizon_decay = 1,
                                                     .seed = seed},
                                      1);
      for (const float u : solver->solve(evaluator, {}).inputs) sum += std::abs(static_cast<double>(u) - 1);
    }
    return sum / 60;
  };
  const double annealed = error(0.6), constant = error(1);
  EXPECT_LT(annealed, 0.3 * constant) << annealed << " and " << constant;
}

}  // namespace
}  // namespace slalom
