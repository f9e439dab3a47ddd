// Trajectories with the cost of each state: their sums are those of `predict`.
#include "slalom/solvers/trajectories.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/problems/arm.hpp"
#include "slalom/problems/differential_drive.hpp"

namespace slalom {
namespace {

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
