// Fits of curves whose parameters are known.
#include "vehicle/model/least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slalom::vehicle::detail::least_squares_test {
namespace {

/// y = 2 exp(-0.5 x) at x = 0, 0.1, ..., 4.9.
void residuals(std::span<const double> p, std::vector<double>& out) {
  out.clear();
  for (int i = 0; i < 50; ++i) {
    const double x = 0.1 * i;
    out.push_back(p[0] * std::exp(-p[1] * x) - 2 * std::exp(-0.5 * x));
  }
}

TEST(LeastSquares, FindsTheParametersOfACurve) {
  const std::vector<FitParameter> parameters{{0, 10, 1e-4}, {0, 10, 1e-4}};
  const Fit fit = least_squares(residuals, parameters, {1, 2});
  EXPECT_NEAR(fit.values[0], 2, 1e-6);
  EXPECT_NEAR(fit.values[1], 0.5, 1e-6);
  EXPECT_NEAR(fit.sum, 0, 1e-12);
}

TEST(LeastSquares, StaysWithinTheRangesAlsoFromAStartOutside) {
  const std::vector<FitParameter> parameters{{0, 1.5, 1e-4}, {0, 10, 1e-4}};
  for (const double start : {0.5, 2.0}) {
    const Fit fit = least_squares(residuals, parameters, {start, 0.5});
    EXPECT_EQ(fit.values[0], 1.5) << start;
    EXPECT_LT(fit.values[1], 0.5) << start;
  }
}

TEST(LeastSquares, AParameterThatIsNotSoughtKeepsItsValueAndHasNoDeviation) {
  const std::vector<FitParameter> parameters{{0, 1.5, 1e-4, false}, {0, 10, 1e-4}};
  const Fit fit = least_squares(residuals, parameters, {2, 3});
  EXPECT_EQ(fit.values[0], 2);
  EXPECT_NEAR(fit.values[1], 0.5, 1e-6);
  const std::vector<double> spread = deviations(fit, parameters, 0.01);
  EXPECT_EQ(spread[0], 0);
  EXPECT_GT(spread[1], 0);
}

TEST(LeastSquares, WhatTheResidualsDoNotDetermineHasAnInfiniteDeviation) {
  const auto constant = [](std::span<const double> p, std::vector<double>& out) {
    out = {p[0] - 1, p[0] - 3};
  };
  const std::vector<FitParameter> parameters{{-10, 10, 1e-4}, {-10, 10, 1e-4}};
  const Fit fit = least_squares(constant, parameters, {0, 5});
  EXPECT_NEAR(fit.values[0], 2, 1e-6);
  EXPECT_EQ(deviations(fit, parameters, 1)[1], INFINITY);
}

}  // namespace
}  // namespace slalom::vehicle::detail::least_squares_test
