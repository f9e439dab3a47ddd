#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "slalom/solvers/controllers.hpp"
#include "slalom/solvers/registry.hpp"
#include "solvers/problems.hpp"

/// Signs of poor plans in the samples of a solve.
namespace slalom {
namespace {

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

/// A point that is held at 0 with a long horizon, and the symptom after that.
Symptom while_holding(const char* method, double horizon_steps) {
  SolverOptions options = solver_options(method);
  *options.find<int>("horizon") = static_cast<int>(horizon_steps);
  *options.find<PerInput>("input_min") = -10;
  *options.find<PerInput>("input_max") = 10;
  Controller controller(testing::DoubleIntegrator{}, options);
  testing::DoubleIntegrator::State<double> x{0, 0};
  for (int k = 0; k < 200; ++k)
    x = controller.problem().step(x, controller.solve(x, {.elapsed = 0.1}).inputs[0]);
  return controller.solve(x, {.elapsed = 0.1}).stats.symptom();
}

TEST(Symptoms, TellNoisyPlans) {
  EXPECT_EQ(while_holding("mppi", 80), Symptom::noisy_plan);
  EXPECT_EQ(while_holding("svg_mppi", 80), Symptom::none);
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
