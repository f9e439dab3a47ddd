#include <gtest/gtest.h>

#include <limits>

#include "slalom/slalom.hpp"
#include "solvers/problems.hpp"

namespace slalom {
namespace {

using testing::DoubleIntegrator;

TEST(Controller, PlansTheStatesThatItsInputsLeadTo) {
  SvgMppi controller{DoubleIntegrator{}, {.horizon = 12, .samples = 256, .input_min = -2, .input_max = {2}}};
  const DoubleIntegrator::State<double> start{0.5, -0.1};
  const auto plan = controller.solve(start, {.elapsed = 0.1});
  ASSERT_EQ(plan.status, Status::ok);
  ASSERT_EQ(plan.inputs.size(), 12u);
  ASSERT_EQ(plan.states.size(), 13u);
  auto x = start;
  double cost = 0;
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(plan.states[k].position, x.position);
    EXPECT_EQ(plan.inputs[k][0], static_cast<double>(plan.stats.inputs[k]));
    cost += controller.problem().stage_cost(x, plan.inputs[k]);
    x = controller.problem().step(x, plan.inputs[k]);
  }
  EXPECT_EQ(plan.states[12].speed, x.speed);
  EXPECT_DOUBLE_EQ(plan.cost, cost + controller.problem().terminal_cost(x));
  EXPECT_FALSE(plan.collided);
}

TEST(Controller, RepeatsThePlanWhereTheStateIsNotFinite) {
  Mppi controller{DoubleIntegrator{}, {.horizon = 5, .input_min = {-2}, .input_max = {2}}};
  const auto first = controller.solve({0.5, 0});
  const std::vector<Input<double, 1>> inputs(first.inputs.begin(), first.inputs.end());
  const auto second = controller.solve({std::numeric_limits<double>::quiet_NaN(), 0});
  EXPECT_EQ(second.status, Status::non_finite_state);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(second.inputs[k][0], inputs[k][0]);
  EXPECT_EQ(second.states[0].position, 0.5);
}

TEST(Controller, HasAnAnswerBeforeTheFirstSolve) {
  Mppi controller{DoubleIntegrator{}, {.horizon = 5}};
  const auto plan = controller.solve({0, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(plan.status, Status::non_finite_state);
  ASSERT_EQ(plan.inputs.size(), 5u);
  EXPECT_EQ(plan.inputs[0][0], 0.0);
  EXPECT_TRUE(plan.stats.weights.empty());
}

TEST(Controller, TakesParametersThatChangeBetweenSolves) {
  Mppi controller{DoubleIntegrator{}, {.horizon = 5, .input_min = {-2}, .input_max = {2}}};
  controller.problem().dt = 0.2;
  const auto plan = controller.solve({0.5, 1.0});
  EXPECT_DOUBLE_EQ(plan.states[1].position, 0.7);
}

TEST(Controller, RefusesASolverForOtherInputs) {
  EXPECT_THROW(Controller(DoubleIntegrator{}, make_solver(MppiOptions{}, 2)), std::invalid_argument);
  EXPECT_THROW(Controller(DoubleIntegrator{}, nullptr), std::invalid_argument);
  EXPECT_THROW(Mppi(DoubleIntegrator{}, {.input_min = {-1, -2}}), std::invalid_argument);
}

}  // namespace
}  // namespace slalom
