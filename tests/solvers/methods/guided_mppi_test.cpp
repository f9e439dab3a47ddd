/// `svg_mppi` in batches: docs/algorithms/svg-mppi.md.
/// Differences between `icem` and `cem`; solver_contract_test.cpp tests every method.
/// Differences between `dial_mpc` and `mppi`; solver_contract_test.cpp tests every method.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "slalom/problems/cart_pole.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/dial_mpc_options.hpp"
#include "slalom/solvers/icem_options.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/solver_base.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/methods/fine_noise.hpp"
#include "solvers/methods/guide_search.hpp"
#include "solvers/problems.hpp"
#include "solvers/set_option.hpp"

namespace slalom {
namespace {

constexpr int horizon = 12;

/// Costs with several minima, which differ from seed to seed.
auto waves(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double place = 2 * uniform(random), slope = uniform(random), pitch = 3 + 2 * uniform(random);
  return testing::sum_over_steps([=](double u, int t) {
    return (u - place) * (u - place) + 2 * std::cos(pitch * u + t) + slope * std::abs(u);
  });
}

double cost_of(const BatchEvaluator& evaluator, std::span<const float> sequence) {
  SequenceBatch batch(horizon, 1, 1);
  batch.set_sample(0, sequence);
  float cost[simd::padding];
  std::uint8_t collided[simd::padding];
  evaluator.evaluate(batch, 0, 1, cost, collided);
  return cost[0];
}

std::unique_ptr<Solver> make(const char* method, int samples) {
  SolverOptions options = solver_options(method);
  testing::set(options, "horizon", horizon);
  testing::set(options, "samples", samples);
  testing::set(options, "input_min", -3);
  testing::set(options, "input_max", 3);
  return make_solver(options, 1);
}

TEST(GuidedMppi, SamplesAreTheRolloutsOfASolve) {
  int evaluated = 0;
  const auto evaluator = testing::sum_over_steps([&](double u, int) { return ++evaluated, u * u; });
  for (const int batches : {0, 2, 3, 8}) {
    for (int samples = 100; samples < 110; ++samples) {
      const auto solver =
          make_solver(SvgMppiOptions{.horizon = 8, .samples = samples, .batches = batches}, 1);
      solver->solve(evaluator, {});
      evaluated = 0;
      solver->solve(evaluator, {});
      EXPECT_EQ(evaluated / 8, samples) << batches;
    }
  }
}

TEST(GuidedMppi, NoPlanCostsMoreThanWhatIsKnown) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> input(-3, 3);
  for (unsigned problem = 0; problem < 1000; ++problem) {
    const auto evaluator = waves(problem);
    const auto solver = make("svg_mppi", 32 << (problem % 5));
    for (int solve = 0; solve < 3; ++solve) {
      const double elapsed = 0.05 * static_cast<double>(problem % 3);  // of a step of 0.05 s
      std::vector<float> proposals(3 * horizon), shifted(horizon);
      for (float& u : proposals) u = input(random);
      const std::vector<float> last(solver->result().inputs.begin(), solver->result().inputs.end());
      const std::vector<float> guide(solver->result().nominal.begin(), solver->result().nominal.end());
      solver->solve(evaluator, {elapsed, 1e9, {proposals, 3}});
      const double rounding = 1e-5, cost = cost_of(evaluator, solver->result().inputs) - rounding;
      for (const std::vector<float>& known : {last, guide}) {
        shift_sequence(known.data(), horizon, 1, elapsed / 0.05, shifted.data());
        EXPECT_LE(cost, cost_of(evaluator, shifted)) << problem;
      }
      for (int p = 0; p < 3; ++p)
        EXPECT_LE(cost, cost_of(evaluator, std::span(proposals).subspan(p * horizon, horizon))) << problem;
    }
  }
}

TEST(Proposals, NoMethodThatTakesThemReturnsAPlanThatCostsMore) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> input(-3, 3);
  for (const char* method : {"mppi", "svg_mppi", "cem", "icem", "dial_mpc"}) {
    for (unsigned problem = 0; problem < 200; ++problem) {
      const auto evaluator = waves(problem);
      const auto solver = make(method, 32);
      std::vector<float> proposals(40 * horizon);
      for (float& u : proposals) u = input(random);
      const auto plan = solver->solve(evaluator, {.proposals = {proposals, 40}}).inputs;
      const int taken = method == std::string("svg_mppi") ? 12 : 40;  // as many as a batch has room for
      for (int p = 0; p < taken; ++p)
        EXPECT_LE(cost_of(evaluator, plan) - 1e-5,
                  cost_of(evaluator, std::span(proposals).subspan(p * horizon, horizon)))
            << method;
    }
  }
}

TEST(GuidedMppi, HoldsExactlyWithALongHorizon) {
  SolverOptions options = solver_options("svg_mppi");
  testing::set(options, "horizon", 80);  // 1.6 s
  testing::set(options, "input_min", -10);
  testing::set(options, "input_max", 10);
  Controller<problems::CartPole> controller{problems::CartPole{}, options};
  problems::CartPole::State<double> state{0, 0, 0.2, 0};
  double worst = 0;
  for (int k = 0; k < 300; ++k) {
    state = controller.problem().step(state, controller.solve(state, {.elapsed = 0.02}).inputs[0]);
    if (k >= 200) worst = std::max(worst, std::abs(state.angle));
  }
  EXPECT_LT(worst, 0.002);
}

TEST(GuidedMppi, APlanOfWhichNothingBetterIsFoundDoesNotDrift) {
  const auto flat = testing::sum_over_steps([](double, int) { return 7.0; });
  const auto solver =
      make_solver(SvgMppiOptions{.horizon = horizon, .samples = 256, .input_min = -1, .input_max = 3}, 1);
  for (int k = 0; k < 100; ++k)
    for (const float u : solver->solve(flat, {.elapsed = 0.05}).inputs) ASSERT_EQ(u, 0);
}

TEST(FineNoise, GrowsWhereItWinsAndShrinksWhereItDoesNot) {
  detail::FineNoise noise(std::vector<float>(4, 0.25f));
  EXPECT_FLOAT_EQ(noise.deviation()[0], 0.5f);
  for (int i = 0; i < 10; ++i) noise.learn_scale(false);
  EXPECT_NEAR(noise.deviation()[0], 0.5 * std::pow(0.7, 10), 1e-6);
  noise.learn_scale(true);
  EXPECT_NEAR(noise.deviation()[0], 0.5 * std::pow(0.7, 10) * 1.3, 1e-6);
  for (int i = 0; i < 100; ++i) noise.learn_scale(false);
  EXPECT_NEAR(noise.deviation()[0], 0.5e-4, 1e-8);
}

TEST(FineNoise, TakesTheShapeOfTheWeightedSamples) {
  detail::FineNoise noise(std::vector<float>(2, 1.0f));
  for (int i = 0; i < 10; ++i) noise.learn_scale(false);
  for (int i = 0; i < 100; ++i) {
    const auto& drawn = noise.deviation();
    noise.learn_shape(
        {0.25 * static_cast<double>(drawn[0] * drawn[0]), static_cast<double>(drawn[1] * drawn[1])});
  }
  EXPECT_LT(noise.deviation()[0], 0.01f * noise.deviation()[1]);
}

TEST(GuideSearch, LearnsTheColourOfItsBestSamples) {
  detail::GuideSearch guide;
  for (int i = 0; i < 3; ++i) guide.learn_colour(true);
  EXPECT_NEAR(guide.white, 1 - 0.5 * std::pow(0.8, 3), 1e-12);
  for (int i = 0; i < 50; ++i) guide.learn_colour(false);
  EXPECT_NEAR(guide.white, 0.05, 1e-9);
}

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
