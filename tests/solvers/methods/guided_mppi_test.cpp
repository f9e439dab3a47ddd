#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "slalom/problems/cart_pole.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/solver_base.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "solvers/methods/fine_noise.hpp"
#include "solvers/methods/guide_search.hpp"
#include "solvers/problems.hpp"
#include "solvers/set_option.hpp"

/// `svg_mppi` in batches: docs/algorithms/svg-mppi.md.
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

}  // namespace
}  // namespace slalom
