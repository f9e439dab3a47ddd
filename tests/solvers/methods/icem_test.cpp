/// Differences between `icem` and `cem`; solver_contract_test.cpp tests every method.
/// Differences between `dial_mpc` and `mppi`; solver_contract_test.cpp tests every method.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "slalom/solvers/dial_mpc_options.hpp"
#include "slalom/solvers/icem_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/registry.hpp"
#include "solvers/problems.hpp"

namespace slalom {
namespace {

/// A cost with many local minima.
auto rough() {
  return testing::sum_over_steps(
      [](double u, int t) { return (u - 1) * (u - 1) + 2 * std::sin(9 * u + t) * std::sin(9 * u + t); });
}

TEST(Icem, SamplesFallByTheDecayToTwiceTheElites) {
  const auto evaluator = rough();
  const auto last_batch = [&](int samples, int iterations, double decay, int rollouts) {
    const auto solver = make_solver(
        IcemOptions{.samples = samples, .iterations = iterations, .elite_share = 0.1, .sample_decay = decay},
        1);
    const SolveResult& result = solver->solve(evaluator, {});
    EXPECT_EQ(result.rollouts, rollouts);
    return result.samples->samples();
  };
  EXPECT_EQ(last_batch(100, 1, 1.25, 100), 100);
  EXPECT_EQ(last_batch(180, 2, 1.25, 180), 80);
  EXPECT_EQ(last_batch(295, 4, 1.25, 295), 51);   // 100, 80, 64, 51.2
  EXPECT_EQ(last_batch(2000, 20, 1, 2000), 100);  // equal batches
  EXPECT_EQ(last_batch(100, 20, 1.25, 133), 4);   // two elites
}

TEST(Icem, ElitesStayInTheNextSolve) {
  const auto evaluator = rough();
  const auto falls = [&](double kept_share) {
    const auto solver = make_solver(IcemOptions{.horizon = 12,
                                                .samples = 60,
                                                .iterations = 1,
                                                .elite_share = 0.1,
                                                .kept_elite_share = kept_share,
                                                .shift_warm_start = false},
                                    1);
    bool always = true;
    double before = solver->solve(evaluator, {}).minimum_cost;
    for (int i = 0; i < 20; ++i) {
      const double now = solver->solve(evaluator, {}).minimum_cost;
      always = always && now <= before;
      before = now;
    }
    return always;
  };
  EXPECT_TRUE(falls(0.5));
  EXPECT_FALSE(falls(0));
}

TEST(Icem, ElitesAreTheBestSamplesAndMoveWithTheTime) {
  const auto evaluator = rough();
  const IcemOptions options{
      .horizon = 6, .samples = 50, .iterations = 1, .elite_share = 0.1, .kept_elite_share = 0.4};
  const auto solver = make_solver(options, 1);
  const SolveResult& result = solver->solve(evaluator, {});
  std::vector<int> order(50);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return result.costs[a] < result.costs[b]; });
  std::vector<std::vector<float>> best;
  for (int i = 0; i < 2; ++i) {
    best.push_back(testing::sequence(*result.samples, order[i]));
    best.back().erase(best.back().begin());  // one step of time passes
    best.back().push_back(best.back().back());
  }
  solver->solve(evaluator, {.elapsed = evaluator.time_step()});
  EXPECT_EQ(testing::sequence(*result.samples, 49), best[0]);
  EXPECT_EQ(testing::sequence(*result.samples, 48), best[1]);
  solver->reset(0);
  const auto again = make_solver(options, 1);
  const std::vector<float> fresh = testing::sequence(*again->solve(evaluator, {}).samples, 49);
  EXPECT_EQ(testing::sequence(*solver->solve(evaluator, {}).samples, 49), fresh)
      << "a reset forgets the elites";
}

TEST(Icem, TheMeanIsASampleOfTheLastIteration) {
  const auto evaluator = rough();
  const IcemOptions options{
      .horizon = 6, .samples = 50, .iterations = 1, .kept_elite_share = 0, .shift_warm_start = false};
  const auto solver = make_solver(options, 1);
  const SolveResult& result = solver->solve(evaluator, {});
  const std::vector<float> mean(result.mean.begin(), result.mean.end());
  solver->solve(evaluator, {});
  EXPECT_EQ(testing::sequence(*result.samples, 49), mean);
}

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
