/// Control sequences of other controllers in a solve; solver_contract_test.cpp tests what holds without them.
/// Signs of poor plans in the samples of a solve.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "slalom/solvers/controllers.hpp"
#include "slalom/solvers/proposals.hpp"
#include "slalom/solvers/registry.hpp"
#include "solvers/problems.hpp"
#include "solvers/set_option.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

constexpr int steps = 10;
const char* const taking[] = {"mppi", "svg_mppi", "cem", "icem", "dial_mpc"};

/// The cost is least, 0, where every input is 3: far from the samples of `make`.
auto far_away() {
  return testing::sum_over_steps([](double u, int) { return 100 * (u - 3) * (u - 3); });
}

std::unique_ptr<Solver> make(const char* method) {
  SolverOptions options = solver_options(method);
  testing::set(options, "horizon", steps);
  testing::set(options, "variance", 0.01);
  testing::set(options, "input_min", -4);
  testing::set(options, "input_max", 4);
  return make_solver(options, 1);
}

double mean_error(const SolveResult& result) {
  double sum = 0;
  for (const float u : result.inputs) sum += std::abs(static_cast<double>(u) - 3);
  return sum / static_cast<double>(result.inputs.size());
}

TEST(Proposals, AGoodOneDecidesTheSolution) {
  const auto evaluator = far_away();
  const std::vector<float> values(2 * steps, 3.0f);
  for (const char* method : taking) {
    const auto without = make(method), with = make(method);
    EXPECT_TRUE(with->takes_proposals()) << method;
    const double alone = mean_error(without->solve(evaluator, {}));
    const double helped = mean_error(with->solve(evaluator, {.proposals = {values, 2}}));
    EXPECT_LT(helped, std::string(method) == "cem" ? alone : 0.1) << method;
  }
}

TEST(Proposals, TheyAreTheLastSamplesInTheirOrder) {
  const auto evaluator = far_away();
  std::vector<float> values(2 * steps, 1.0f);
  std::fill(values.begin() + steps, values.end(), 2.0f);
  const auto solver = make("mppi");
  const SolveResult& result = solver->solve(evaluator, {.proposals = {values, 2}});
  const int count = result.samples->samples();
  for (int t = 0; t < steps; ++t) {
    EXPECT_EQ(result.samples->at(t, 0, count - 2), 1.0f);
    EXPECT_EQ(result.samples->at(t, 0, count - 1), 2.0f);
    EXPECT_NE(result.samples->at(t, 0, count - 3), result.samples->at(t, 0, count - 1));
  }
  EXPECT_GT(result.weights[static_cast<std::size_t>(count) - 1], 0.99f);
  solver->solve(evaluator, {});
  EXPECT_NE(result.samples->at(0, 0, count - 1), 2.0f) << "they count for one solve only";
}

TEST(Proposals, AreRejectedByOtherMethods) {
  const auto evaluator = far_away();
  const std::vector<float> values(steps, 3.0f);
  for (const char* method : {"reverse_mppi", "sv_mpc"}) {
    const auto without = make(method), with = make(method);
    EXPECT_FALSE(with->takes_proposals());
    const auto a = without->solve(evaluator, {}).inputs;
    const auto b = with->solve(evaluator, {.proposals = {values, 1}}).inputs;
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin())) << method;
  }
}

using testing::DoubleIntegrator;

Mppi<DoubleIntegrator> pushed() {
  return Mppi{DoubleIntegrator{}, {.horizon = steps, .samples = 64, .input_min = -1, .input_max = 1}};
}

TEST(Proposals, FollowALawWithinTheBounds) {
  const auto controller = pushed();
  Proposals proposals{controller, 1};
  const DoubleIntegrator::State<double> start{1, 0.5};
  const auto law = [](const DoubleIntegrator::State<double>& x, int k) {
    return Input<double, 1>{{-2 * x.position - x.speed + 0.01 * k}};
  };
  EXPECT_TRUE(proposals.follow(controller, start, law));
  EXPECT_FALSE(proposals.follow(controller, start, law)) << "there is room for one";
  EXPECT_EQ(proposals.size(), 1);
  const SequenceList list = proposals;
  auto x = start;
  for (int k = 0; k < steps; ++k) {
    const double u = std::clamp(law(x, k)[0], -1.0, 1.0);
    EXPECT_EQ(list.values[k], static_cast<float>(u)) << k;
    x = controller.problem().step<double>(x, {{u}});
  }
}

TEST(Proposals, ShortSequencesHoldTheirLastInputs) {
  const auto controller = pushed();
  Proposals proposals{controller, 2};
  const std::vector<Input<double, 1>> inputs{{{0.5}}, {{-3}}};
  EXPECT_TRUE(proposals.add(inputs));
  EXPECT_FALSE(proposals.add({}));
  const SequenceList list = proposals;
  ASSERT_EQ(list.sequences, 1);
  EXPECT_EQ(list.values[0], 0.5f);
  for (std::size_t k = 1; k < steps; ++k) EXPECT_EQ(list.values[k], -1.0f);
  proposals.clear();
  EXPECT_EQ(proposals.size(), 0);
}

TEST(Proposals, MistakesNameTheRule) {
  EXPECT_EQ(message_of([] { Proposals{pushed(), 0}; }), "proposals: capacity 0 must be at least 1");
  EXPECT_EQ(message_of([] {
              Proposals{SvMpc{DoubleIntegrator{}}, 1};
            }),
            "proposals: the method sv_mpc does not accept proposals");
}

/// The symptom after many solves with a cost that is a function of the inputs, summed over the steps.
template <class Cost>
Symptom after_solves(SolverOptions options, Cost cost, int solves = 2 * SolveResult::symptom_patience) {
  *options.find<int>("horizon") = 8;
  *options.find<int>("samples") = 256;
  *options.find<PerInput>("input_min") = -1;
  *options.find<PerInput>("input_max") = 1;
  const auto solver = make_solver(options, 1);
  const auto evaluator = testing::sum_over_steps([&](double u, int) { return cost(u); });
  for (int i = 0; i < solves; ++i) solver->solve(evaluator, {});
  return solver->result().symptom();
}

double spring_cost(double u) {
  return (u - 0.3) * (u - 0.3);
}

TEST(Symptoms, AreNamedWhenTheyStay) {
  const MppiOptions cold{.temperature = 1e-6}, hot{.temperature = 1e6}, narrow{.variance = 1e-6};
  EXPECT_EQ(after_solves(cold, spring_cost), Symptom::few_samples);
  EXPECT_EQ(after_solves(cold, spring_cost, SolveResult::symptom_patience - 1), Symptom::none);
  EXPECT_EQ(after_solves(hot, spring_cost), Symptom::equal_costs);
  EXPECT_EQ(after_solves(narrow, spring_cost), Symptom::small_variance);
  for (const char* method : {"mppi", "svg_mppi", "icem", "cem", "dial_mpc"}) {
    const SolverOptions options = solver_options(method);
    EXPECT_EQ(after_solves(options, [](double) { return 3.0; }), Symptom::equal_costs) << method;
    EXPECT_EQ(after_solves(options, [](double u) { return 1e7 + spring_cost(u); }), Symptom::equal_costs)
        << method;
    EXPECT_EQ(after_solves(options, [](double u) { return 3 - u; }), Symptom::saturated_inputs) << method;
    EXPECT_EQ(after_solves(options, [](double u) { return 3 + spring_cost(u); }), Symptom::no_progress)
        << method;
  }
}

/// Of the last 100 solves for a point that is held at 0 with a long horizon, those with a noisy plan.
int noisy_plans(const char* method) {
  SolverOptions options = solver_options(method);
  *options.find<int>("horizon") = 80;
  *options.find<PerInput>("input_min") = -10;
  *options.find<PerInput>("input_max") = 10;
  Controller controller(testing::DoubleIntegrator{}, options);
  testing::DoubleIntegrator::State<double> x{0, 0};
  int noisy = 0;
  for (int k = 0; k < 200; ++k) {
    const auto plan = controller.solve(x, {.elapsed = 0.1});
    noisy += k >= 100 && plan.stats.symptom() == Symptom::noisy_plan;
    x = controller.problem().step(x, plan.inputs[0]);
  }
  return noisy;
}

TEST(Symptoms, TellNoisyPlans) {
  EXPECT_GT(noisy_plans("mppi"), 0);
  EXPECT_EQ(noisy_plans("svg_mppi"), 0);
}

TEST(Symptoms, TellSamplesThatDiverge) {
  for (const double high : {1e12, std::numeric_limits<double>::quiet_NaN()}) {
    const auto cost = [high](double u) { return u > 0 ? high : 1 - u; };
    EXPECT_EQ(after_solves(MppiOptions{}, cost), Symptom::samples_diverge) << high;
  }
  EXPECT_NE(after_solves(MppiOptions{}, [](double u) { return u > 0 ? 1e6 : 1 - u; }),
            Symptom::samples_diverge);
}

TEST(Symptoms, AreNoneOnTheWayAndAtTheGoal) {
  for (const char* method : {"mppi", "svg_mppi", "icem", "cem", "dial_mpc"}) {
    SolverOptions options = solver_options(method);
    *options.find<PerInput>("input_min") = -2;
    *options.find<PerInput>("input_max") = 2;
    Controller controller(testing::DoubleIntegrator{}, options);
    testing::DoubleIntegrator::State<double> x{2, 0};
    for (int k = 0; k < 100; ++k) {
      const auto plan = controller.solve(x, {.elapsed = 0.1});
      EXPECT_STREQ(name(plan.stats.symptom()), "none") << method << " " << k;
      x = controller.problem().step(x, plan.inputs[0]);
    }
  }
}

TEST(Symptoms, EndWithAReset) {
  const auto solver = make_solver(MppiOptions{.horizon = 8, .samples = 64, .temperature = 1e-6}, 1);
  const auto evaluator = testing::sum_over_steps([](double u, int) { return spring_cost(u); });
  for (int i = 1; i < 4; ++i) EXPECT_EQ(solver->solve(evaluator, {}).suspicious_solves, i);
  solver->reset(1);
  EXPECT_EQ(solver->solve(evaluator, {}).suspicious_solves, 1);
  for (int i = 0; i < 8; ++i)
    EXPECT_EQ(std::string(explanation(static_cast<Symptom>(i))).empty(), i == 0) << i;
}

}  // namespace

}  // namespace slalom
