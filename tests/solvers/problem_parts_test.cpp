// Controllers of problems with bounds, limits of rates, or noise of their own; trajectories by cost term.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "slalom/problems/arm.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/slalom.hpp"
#include "slalom/solvers/trajectories.hpp"
#include "solvers/problems.hpp"

namespace slalom {
namespace {

using testing::DoubleIntegrator;

struct Bounded : DoubleIntegrator {
  double input_min = -0.25;
  std::array<double, 1> input_max{0.75};
};

/// Far away, so that every method wants to push as hard as it may.
constexpr DoubleIntegrator::State<double> far_left{-50, 0}, far_right{50, 0};

template <class P>
void expect_within(P problem, SolverOptions options, double low, double high) {
  *options.find<PerInput>("variance") = 4;
  Controller<P> controller(problem, options);
  double least = 1e9, largest = -1e9;
  for (int k = 0; k < 3; ++k) {
    for (const auto& start : {far_left, far_right}) {
      for (const auto& u : controller.solve(start).inputs) {
        least = std::min(least, u[0]);
        largest = std::max(largest, u[0]);
      }
    }
  }
  EXPECT_GE(least, low);
  EXPECT_LT(least, low + 0.2);
  EXPECT_LE(largest, high);
  EXPECT_GT(largest, high - 0.2);
}

TEST(InputBounds, TheNarrowerOfProblemAndOptionsApplies) {
  expect_within(Bounded{}, MppiOptions{.input_min = -2, .input_max = 0.5}, -0.25, 0.5);
  expect_within(Bounded{}, MppiOptions{.input_min = {-0.125}, .input_max = 3}, -0.125, 0.75);
}

struct Slow : DoubleIntegrator {
  double input_rate_max = 2;  // a step of 0.1 s: 0.2
};

TEST(RateLimits, StartFromTheAppliedInput) {
  Mppi controller{Slow{}, {.horizon = 8, .variance = 4, .input_min = -3, .input_max = 3}};
  const auto first = controller.solve(far_left);
  const double third = first.inputs[2][0];
  const auto second = controller.solve(far_left, {.elapsed = 0.3});  // three steps were driven
  const Trajectories again = roll_out(controller.evaluator(), far_left, second.stats.inputs, 8);
  EXPECT_NEAR(again.states[again.states.size() - 2], second.states.back().position, 1e-6);
  const double fourth = second.inputs[0][0];
  EXPECT_LE(std::abs(fourth - third), 0.2 + 1e-12);
  const double next = controller.solve(far_right, {.elapsed = 0.1}).inputs[0][0];  // one step was driven
  EXPECT_NEAR(next, fourth - 0.2, 1e-12);
  controller.set_previous_input({{-2}});
  EXPECT_LE(controller.solve(far_left, {.elapsed = 0.1}).inputs[0][0], -1.8 + 1e-12);
  controller.reset(0);
  EXPECT_LE(std::abs(controller.solve(far_left).inputs[0][0]), 0.2 + 1e-12);
}

/// A thruster: on or off in either direction.
struct Thruster : DoubleIntegrator {
  double input_min = -1, input_max = 1, input_levels = 3;
};

TEST(InputLevels, PlansHaveThemAndReachWhatTheyCannotHold) {
  for (const char* name : solver_names()) {
    Controller<Thruster> controller(Thruster{}, solver_options(name));
    Thruster::State<double> x{1, 0};
    int pushes = 0;
    for (int k = 0; k < 100; ++k) {
      const auto plan = controller.solve(x, {.elapsed = k ? 0.1 : 0});
      for (const auto& u : plan.inputs)
        ASSERT_TRUE(u[0] == -1 || u[0] == 0 || u[0] == 1) << name << ' ' << u[0];
      EXPECT_EQ(plan.corrections, 0);
      const Trajectories again =
          roll_out(controller.evaluator(), x, plan.stats.inputs, controller.solver().horizon());
      EXPECT_EQ(again.states[again.states.size() - 2], plan.states.back().position) << name;
      pushes += plan.inputs[0][0] != 0;
      x = controller.problem().step(x, plan.inputs[0]);
    }
    EXPECT_LT(std::abs(x.position), 0.6) << name;
    EXPECT_GT(pushes, 1) << name;
  }
}

TEST(InputLevels, AreChecked) {
  Thruster thruster;
  thruster.input_levels = 1;
  EXPECT_THROW(Mppi(thruster, {}), std::invalid_argument);
  thruster.input_levels = 2.5;
  EXPECT_THROW(Mppi(thruster, {}), std::invalid_argument);
  thruster.input_levels = 2;
  EXPECT_NO_THROW(Mppi(thruster, {}));
  thruster.input_max = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Mppi(thruster, {}), std::invalid_argument);
}

/// Pushes that hold for four steps at a time.
struct Blocky : DoubleIntegrator {
  void sample(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept {
    fill_normal(noise, first, count, key);
    for (int k = 0; k < noise.steps(); ++k)
      for (int s = first; s < first + count; ++s) noise.at(k, 0, s) = noise.at(k - k % 4, 0, s);
  }
};

template <class Options>
void expect_blocks(Options options) {
  options.horizon = 8;
  options.samples = 200;
  Controller<Blocky> controller(Blocky{}, options);
  controller.prepare();
  const auto plan = controller.solve({0.5, 0});
  const SequenceBatch& samples = *plan.stats.samples;
  for (int s = 0; s < samples.samples(); ++s)
    for (int k = 0; k < 8; ++k) EXPECT_FLOAT_EQ(samples.at(k, 0, s), samples.at(k - k % 4, 0, s)) << s;
  EXPECT_NE(samples.at(0, 0, 3), samples.at(4, 0, 3));
}

TEST(ProblemSampler, ReplacesTheSamplesOfEveryMethod) {
  expect_blocks(MppiOptions{});
  expect_blocks(CemOptions{.iterations = 1});
}

TEST(CostTerms, SumToTheCostOfThePlan) {
  Mppi controller{DoubleIntegrator{}, {.horizon = 6}};
  EXPECT_STREQ(controller.solve({0.5, std::nan("")}).cost_terms[0].name, "stage");
  const auto plan = controller.solve({0.5, 0.1});
  ASSERT_EQ(plan.cost_terms.size(), 2u);
  EXPECT_STREQ(plan.cost_terms[1].name, "terminal");
  EXPECT_NEAR(plan.cost_terms[0].value + plan.cost_terms[1].value, plan.cost, 1e-12);
}

template <class P>
void expect_sums_of_predict(const P& problem, const detail::StateOf<P, double>& x, double value,
                            int collision) {
  std::array<Input<double, P::inputs>, 30> inputs;
  for (auto& u : inputs)
    for (int i = 0; i < P::inputs; ++i) u[i] = i == 0 ? value : 0;
  std::array<detail::StateOf<P, double>, 31> states;
  CostTermsOf<P> terms;
  const Cost<double> cost = predict(problem, x, inputs.data(), 30, states.data(), &terms);
  Trajectories all;
  add_trajectory<P>(all, problem, x, inputs);
  add_trajectory<P>(all, problem, x, inputs);
  ASSERT_EQ(all.states.size(), 2 * sizeof states / sizeof(double));
  EXPECT_EQ(std::memcmp(all.states.data(), states.data(), sizeof states), 0);
  ASSERT_EQ(all.costs.size(), 2 * states.size() * terms.size());
  for (std::size_t t = 0; t < terms.size(); ++t) {
    double sum = 0;
    for (std::size_t k = 0; k < states.size(); ++k) sum += all.costs[k * terms.size() + t];
    EXPECT_NEAR(sum, terms[t].value, 1e-9 * std::abs(sum)) << terms[t].name;
  }
  EXPECT_EQ(all.collisions, (std::vector<int>{collision, collision}));
  EXPECT_EQ(cost.collided, collision >= 0);
}

TEST(Trajectories, SumToTheCostOfPredict) {
  // 1.5 m/s straight on: the disc begins at x = 1.6 m, which the state after 11 steps of 0.15 m has passed.
  expect_sums_of_predict(problems::DifferentialDrive{}, {0, 0, 0}, 1.5, 11);
  expect_sums_of_predict(problems::DifferentialDrive{}, {0, 0, 0}, 0.1, -1);
}

TEST(Trajectories, KeepNamedTerms) {
  problems::Arm::State<double> x;
  std::copy(problems::Arm::start.begin(), problems::Arm::start.end(), x.angle);
  expect_sums_of_predict(problems::Arm{}, x, 0.0, -1);
}

}  // namespace
}  // namespace slalom
