#include "solvers/solver_contract.hpp"

#include <Eigen/Core>

namespace slalom {
namespace {

using namespace testing;

/// The optimal inputs of the double integrator from a state (Riccati recursion).
std::vector<double> optimum(DoubleIntegrator::State<double> x, int horizon) {
  const double dt = DoubleIntegrator{}.dt;
  const Eigen::Matrix2d a{{1, dt}, {0, 1}}, q{{1, 0}, {0, 0.1}};
  const Eigen::Vector2d b(0, dt);
  Eigen::Matrix2d value{{10, 0}, {0, 1}};
  std::vector<Eigen::RowVector2d> gain(horizon);
  for (int k = horizon - 1; k >= 0; --k) {
    gain[k] = b.transpose() * value * a / (0.1 + b.dot(value * b));
    const Eigen::Matrix2d closed = a - b * gain[k];
    value = q + 0.1 * gain[k].transpose() * gain[k] + (closed.transpose() * value * closed).eval();
  }
  std::vector<double> u;
  for (int k = 0; k < horizon; ++k) {
    u.push_back(-gain[k].dot(Eigen::RowVector2d(x.position, x.speed)));
    x = DoubleIntegrator{}.step<double>(x, {{u.back()}});
  }
  return u;
}

TEST_P(SolverContract, FindsTheOptimumOfALinearQuadraticProblem) {
  const auto solver = make(1, [](SolverOptions& o) {
    set(o, "horizon", 15);
    set(o, "input_min", -4);
    set(o, "input_max", 4);
    set(o, "variance", 0.3);
    set_if_any(o, "temperature", 0.1);
    set_if_any(o, "control_cost_discount", 1);
    set(o, "zero_mean_share", 0);
  });
  ProblemEvaluator evaluator(DoubleIntegrator{});
  const DoubleIntegrator::State<double> start{0.5, 0.2};
  evaluator.set_state(start);
  for (int i = 0; i < 60; ++i) solver->solve(evaluator, {});
  const bool departs = published_departs(GetParam().name);
  const double tolerance = departs ? 1 : 0.02;
  std::vector<double> mean(15);
  for (int i = 0; i < 200; ++i) {
    const auto& result = solver->solve(evaluator, {});
    ASSERT_TRUE(result.status == Status::ok || departs) << name(result.status);
    for (std::size_t k = 0; k < 15; ++k) mean[k] += static_cast<double>(result.inputs[k]) / 200;
  }
  // Compared by cost: how much dearer than the optimum, in parts of what doing nothing costs more.
  const auto cost = [&](const std::vector<double>& u) {
    std::vector<Input<double, 1>> inputs;
    for (const double v : u) inputs.push_back({{v}});
    return predict(DoubleIntegrator{}, start, inputs.data(), 15, nullptr).value;
  };
  const double optimal = cost(optimum(start, 15)), idle = cost(std::vector<double>(15));
  const double excess = (cost(mean) - optimal) / (idle - optimal);
  EXPECT_GE(excess, -1e-9);
  std::printf("[ optimum  ] %.4f of the cost of doing nothing above it\n", excess);
  EXPECT_LT(excess, tolerance) << "optimal " << optimal;
}

TEST_P(SolverContract, SamplesAreTheRolloutsOfASolve) {
  int counted = 0;
  const auto evaluator = simple(1, [&](float u, float, int) { return ++counted, u * u; });
  const auto solver = make(1, small);
  solver->solve(evaluator, {});  // dial_mpc makes more updates in it
  counted = 0;
  const int rollouts = solver->solve(evaluator, {}).rollouts;
  EXPECT_EQ(rollouts, counted);
  // The samples of these are particles, of an iteration, or beside those of guides.
  const std::string& name = GetParam().name;
  const bool beside = name.starts_with("svg_mppi_") || solver->name() == std::string("reverse_mppi") ||
                      solver->name() == std::string("sv_mpc");
  if (beside) return;
  EXPECT_EQ(rollouts, std::min(*GetParam().options.find<int>("samples"), 300));
}

TEST_P(SolverContract, EverySampleIsWithinBounds) {
  if (GetParam().name == "sv_mpc_published") GTEST_SKIP() << "the published particles leave the bounds";
  const auto solver = make(1, small);
  const auto evaluator = simple(1, [](float a, float b, int) { return a + b; });
  for (int i = 0; i < 5; ++i) {
    const auto& result = solver->solve(evaluator, {});
    for (int t = 0; t < 10; ++t)
      for (int k = 0; k < result.samples->samples(); ++k) {
        EXPECT_GE(result.samples->at(t, 0, k), -2.0f);
        EXPECT_LE(result.samples->at(t, 0, k), 1.0f);
      }
  }
}

TEST_P(SolverContract, WeightsFallWithCostByTheTemperature) {
  const std::string method = solver_name(GetParam().options);
  if (!GetParam().options.find<double>("temperature") || method == "reverse_mppi" ||
      GetParam().name.ends_with("all_parts")) {
    GTEST_SKIP() << "has weights of another form";
  }
  const auto solver = make(1, [](SolverOptions& o) {
    small(o);
    set_if_any(o, "temperature", 0.7);
    set_if_any(o, "control_cost_discount", 1);
  });
  const auto evaluator = simple(1, [](float a, float b, int) { return 3.0 * a * a + b; });
  const auto& result = solver->solve(evaluator, {});
  const double temperature = result.temperature;
  if (!GetParam().name.ends_with("target_ess_fraction")) {
    ASSERT_EQ(temperature, 0.7);
  }
  double sum = 0;
  std::size_t best = 0;
  for (std::size_t k = 0; k < result.costs.size(); ++k) {
    sum += static_cast<double>(result.weights[k]);
    if (result.weights[k] > result.weights[best]) best = k;
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  const bool in_kinds = GetParam().name.starts_with("svg_mppi");  // only samples of the first guide weigh
  for (std::size_t k = 0; k < result.costs.size(); ++k) {
    if (in_kinds && result.weights[k] == 0) continue;
    const double expected = static_cast<double>(result.weights[best]) *
                            std::exp(static_cast<double>(result.costs[best] - result.costs[k]) / temperature);
    EXPECT_NEAR(result.weights[k], expected, 1e-4 * static_cast<double>(result.weights[best])) << k;
  }
}

TEST_P(SolverContract, ReportsThatAllSamplesCollideAndStillReturnsAPlan) {
  const auto solver = make(1, small);
  const auto evaluator = FunctionEvaluator(1, [](const SequenceBatch& batch, int k) {
    return std::pair(1000.0 + static_cast<double>(batch.at(0, 0, k)), true);
  });
  for (int i = 0; i < 3; ++i) {
    const auto& result = solver->solve(evaluator, {});
    EXPECT_EQ(result.status, Status::all_collided);
    EXPECT_EQ(result.collided_share, 1);
    expect_usable(result, 10, -2, 1);
  }
}

TEST_P(SolverContract, CostsThatAreNotFiniteGiveAStatusAndAFallback) {
  for (const double bad : {infinite, -infinite, std::nan("")}) {
    const auto solver = make(1, small);
    const auto good = simple(1, [](float a, float b, int) { return a * a + b; });
    const auto broken = simple(1, [bad](float, float, int) { return bad; });
    for (int i = 0; i < 3; ++i) expect_usable(solver->solve(good, {}), 10, -2, 1);
    for (int i = 0; i < 3; ++i) {
      const auto& result = solver->solve(broken, {});
      EXPECT_EQ(result.status, Status::degenerate) << bad;
      expect_usable(result, 10, -2, 1);
    }
    const auto& after = solver->solve(good, {});
    EXPECT_EQ(after.status, Status::ok) << bad;
    expect_usable(after, 10, -2, 1);
  }
}

TEST_P(SolverContract, SamplesOfNonFiniteCostHaveNoWeight) {
  for (const double bad : {infinite, -infinite, std::nan("")}) {
    const auto solver = make(1, small);
    const auto evaluator = simple(1, [bad](float a, float b, int k) { return k % 2 ? bad : a * a + b; });
    for (int i = 0; i < 3; ++i) {
      const auto& result = solver->solve(evaluator, {});
      EXPECT_EQ(result.status, Status::ok) << bad;
      expect_usable(result, 10, -2, 1);
      EXPECT_TRUE(std::isfinite(result.minimum_cost));
      EXPECT_TRUE(std::isfinite(result.expected_cost));
      for (std::size_t k = 1; k < result.weights.size(); k += 2) EXPECT_EQ(result.weights[k], 0);
    }
  }
}

TEST_P(SolverContract, AcceptsEnormousAndEqualCosts) {
  for (const double cost : {1e38, -1e38, 0.0, 1e9}) {
    const auto solver = make(1, small);
    const auto evaluator = simple(1, [cost](float, float, int) { return cost; });
    for (int i = 0; i < 3; ++i) expect_usable(solver->solve(evaluator, {}), 10, -2, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverContract, ::testing::ValuesIn(option_sets()),
                         [](const auto& set) { return set.param.name; });

TEST_P(SolverContract, KeepsTheBoundsOfManyInputsOfDifferentScale) {
  const int inputs = 7;
  std::vector<double> low, high, variance;
  for (int i = 0; i < inputs; ++i) {
    low.push_back(i % 2 ? std::pow(2.0, i) : -std::pow(2.0, i));  // every other one excludes 0
    high.push_back(std::pow(3.0, i));
    variance.push_back(std::pow(4.0, i) / 16);
  }
  const auto solver = make(inputs, [&](SolverOptions& o) {
    small(o);
    set(o, "input_min", low);
    set(o, "input_max", high);
    set(o, "variance", variance);
  });
  const auto evaluator = FunctionEvaluator(inputs, [&](const SequenceBatch& batch, int k) {
    double cost = 0;
    for (int t = 0; t < batch.steps(); ++t)
      for (int i = 0; i < inputs; ++i) cost += std::abs(static_cast<double>(batch.at(t, i, k)));
    return std::pair(cost, false);
  });
  for (int n = 0; n < 5; ++n) {
    const auto& result = solver->solve(evaluator, {.elapsed = 0.03});
    for (std::size_t k = 0; k < result.inputs.size(); ++k) {
      EXPECT_GE(static_cast<double>(result.inputs[k]), low[k % inputs]);
      EXPECT_LE(static_cast<double>(result.inputs[k]), high[k % inputs]);
    }
  }
}

}  // namespace
}  // namespace slalom
