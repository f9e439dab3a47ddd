#include "solvers/sampling/spline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "slalom/slalom.hpp"
#include "solvers/problems.hpp"

/// Control sequences as splines, and the particles of sv_mpc that are.
namespace slalom {
namespace {

using detail::Spline;
constexpr int spline_steps = 31;

std::vector<float> expanded(const Spline& spline, const std::vector<float>& points,
                            int length = spline_steps) {
  std::vector<float> sequence(static_cast<std::size_t>(length));
  spline.expand(points.data(), sequence.data());
  return sequence;
}

TEST(Spline, IsAMeanOfItsControlPointsThatStartsAndEndsAtThem) {
  for (const int points : {1, 2, 3, 4, 7, spline_steps}) {
    const Spline spline(spline_steps, points, 1);
    std::vector<float> values;
    for (int p = 0; p < points; ++p) values.push_back(p % 2 == 0 ? 3.0f : -1.0f);
    for (const float v : expanded(spline, std::vector<float>(values.size(), 3.0f))) EXPECT_NEAR(v, 3, 1e-5);
    const std::vector<float> sequence = expanded(spline, values);
    EXPECT_NEAR(sequence.front(), values.front(), 1e-5) << points;
    EXPECT_NEAR(sequence.back(), values.back(), 1e-5) << points;
    for (const float v : sequence) EXPECT_TRUE(v > -1.0001f && v < 3.0001f) << points;
  }
}

TEST(Spline, IsTheCubicThatTheBernsteinPolynomialsGive) {
  const Spline spline(spline_steps, 4, 1);
  const std::vector<float> points{1, -2, 5, 3}, sequence = expanded(spline, points);
  for (int t = 0; t < spline_steps; ++t) {
    const double x = t / (spline_steps - 1.0), y = 1 - x;
    const double value = y * y * y * 1 + 3 * y * y * x * -2 + 3 * y * x * x * 5 + x * x * x * 3;
    EXPECT_NEAR(sequence[static_cast<std::size_t>(t)], value, 1e-5);
  }
}

TEST(Spline, HasSmoothSlopes) {
  const Spline spline(301, 9, 1);
  std::vector<float> points{0, 4, -3, 2, 7, -5, 1, 0, 3};
  const std::vector<float> v = expanded(spline, points, 301);
  for (std::size_t t = 3; t < v.size(); ++t) {
    const auto third = static_cast<double>(v[t] - 3 * v[t - 1] + 3 * v[t - 2] - v[t - 3]);
    EXPECT_LT(std::abs(third), 0.01) << "the second derivative is continuous";
  }
}

TEST(Spline, MovesForwardAsItsSequence) {
  Spline spline(spline_steps, 8, 2);
  std::vector<float> points;
  for (int p = 0; p < 8; ++p) {
    points.push_back(static_cast<float>(std::sin(0.7 * p)));
    points.push_back(static_cast<float>(0.1 * p));
  }
  std::vector<float> still = points, sequence(2 * spline_steps), shifted(2 * spline_steps),
                     got(2 * spline_steps);
  spline.shift(still.data(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(still[i], points[i], 1e-4);
  spline.expand(points.data(), sequence.data());
  shift_sequence(sequence.data(), spline_steps, 2, 1.5, shifted.data());
  spline.shift(points.data(), 1.5);
  spline.expand(points.data(), got.data());
  for (std::size_t i = 0; i < 2 * (spline_steps - 4);
       ++i)  // the held end has a corner, which splines round off
    EXPECT_NEAR(got[i], shifted[i], 0.06) << i;
}

TEST(Spline, ABatchHasTheSameSequences) {
  const Spline spline(spline_steps, 6, 1);
  SequenceBatch points(6, 1, 20), sequences(spline_steps, 1, 20);
  for (int p = 0; p < 6; ++p)
    for (int k = 0; k < 20; ++k) points.at(p, 0, k) = static_cast<float>(std::cos(p * (k + 1)));
  spline.expand(points, sequences, {0, points.stride()});
  for (const int k : {0, 7, 19}) {
    std::vector<float> one(6);
    points.get_sample(k, one);
    const std::vector<float> sequence = expanded(spline, one);
    for (int t = 0; t < spline_steps; ++t)
      EXPECT_NEAR(sequences.at(t, 0, k), sequence[static_cast<std::size_t>(t)], 1e-6);
  }
}

TEST(SvMpcWithSplines, PlansAreSplinesThatSolveTheProblem) {
  const testing::DoubleIntegrator problem;
  SvMpc controller{
      problem,
      {.horizon = 40, .variance = 4, .input_min = -2, .input_max = 2, .step = 4, .control_points = 6}};
  testing::DoubleIntegrator::State<double> x{1, 0};
  for (int k = 0; k < 60; ++k) {
    const auto plan = controller.solve(x, {.elapsed = problem.dt});
    ASSERT_EQ(plan.stats.inputs.size(), 40u);
    ASSERT_EQ(plan.stats.variances.size(), 40u);
    ASSERT_EQ(plan.stats.samples->steps(), 40);
    ASSERT_EQ(plan.stats.samples->samples(), static_cast<int>(plan.stats.weights.size()));
    for (std::size_t t = 0; t < 40; ++t) EXPECT_LE(std::abs(plan.inputs[t][0]), 2.0);
    for (std::size_t t = 3; t < 40; ++t) {
      const double third =
          plan.inputs[t][0] - 3 * plan.inputs[t - 1][0] + 3 * plan.inputs[t - 2][0] - plan.inputs[t - 3][0];
      EXPECT_LT(std::abs(third), 0.05) << "white noise of this variance has differences of several units";
    }
    x = problem.step<double>(x, plan.inputs[0]);
  }
  EXPECT_LT(std::abs(x.position), 0.15);
}

TEST(SvMpcWithSplines, ParticlesStayWithinTheBoundsWhenTheyMoveForward) {
  const testing::DoubleIntegrator problem;
  SvMpc controller{problem,
                   {.horizon = 40, .variance = 100, .input_min = -2, .input_max = 2, .control_points = 10}};
  // No time to move the particles: they are evaluated as they were drawn, and then as they were shifted.
  controller.solve({1, 0}, {.deadline = 1e-9});
  const auto plan = controller.solve({1, 0}, {.elapsed = 2.5 * problem.dt, .deadline = 1e-9});
  std::vector<float> sequence(40);
  float largest = 0;
  for (int k = 0; k < plan.stats.samples->samples(); ++k) {
    plan.stats.samples->get_sample(k, sequence);
    for (const float value : sequence) largest = std::max(largest, std::abs(value));
  }
  EXPECT_LE(largest, 2.0001f);
  EXPECT_GT(largest, 1.9f) << "none is near a bound";
}

}  // namespace
}  // namespace slalom
