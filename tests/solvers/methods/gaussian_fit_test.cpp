#include "solvers/methods/gaussian_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slalom::detail {
namespace {

/// The variance fitted to points of a Gaussian with the mean 0.3 more than the first abscissa; infinite if it
/// is undetermined.
double fitted(double variance, double first, double spacing, double error = 0) {
  std::vector<double> x, density;
  for (int k = 0; k < 10; ++k) {
    x.push_back(first + spacing * k);
    const double d = spacing * k - 0.3;
    density.push_back(std::exp(-0.5 * d * d / variance));
  }
  std::vector<double> square(x.size()), logarithm(x.size());
  const int count = static_cast<int>(x.size());
  fit_weights(density.data(), count, square.data(), logarithm.data());
  return fitted_variance(fit_gaussian(x.data(), square.data(), logarithm.data(), count, error), false);
}

TEST(GaussianFit, FindsTheVarianceWhereverTheMeanIs) {
  for (const double first : {0.0, -3.0, 100.0, 1000.0}) {
    EXPECT_NEAR(fitted(0.04, first, 0.1), 0.04, 1e-9) << first;
    EXPECT_NEAR(fitted(0.5, first, 0.1), 0.5, 1e-8) << first;
  }
}

TEST(GaussianFit, IsUndeterminedWhereRoundingDecides) {
  EXPECT_TRUE(std::isinf(fitted(0.04, 1, 0)));
  // Abscissas that float32 does not tell apart, and densities that differ less than their error.
  EXPECT_TRUE(std::isinf(fitted(0.04, 1, 1e-8)));
  EXPECT_TRUE(std::isinf(fitted(0.04, 1, 1e-3, 1e-2)));
  EXPECT_FALSE(std::isinf(fitted(0.04, 1, 0.1, 1e-2)));
}

}  // namespace
}  // namespace slalom::detail
