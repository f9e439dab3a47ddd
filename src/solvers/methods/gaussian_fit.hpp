#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

/// A Gaussian fitted to points of its density (Guo, "A Simple Algorithm for Fitting a Gaussian Function",
/// IEEE Signal Processing Magazine 28(5), 2011; Honda et al., ICRA 2024, equation (13)):
/// ln y = z0 + z1 x + z2 x^2 is fitted by least squares with weight y^2 for each point, in double precision.
namespace slalom::detail {

/// The result of a fit.
struct GaussianFit {
  double curvature = 0;     ///< z2, which is -1 / (2 variance) for a Gaussian; 0 if undetermined
  bool determined = false;  ///< whether the points determine the curvature
};

/// Computes the squares and logarithms of the densities of `count` points. Those below 1e-10 count as 1e-10.
inline void fit_weights(const double* density, int count, double* square, double* logarithm) {
  for (int k = 0; k < count; ++k) {
    const double y = std::max(density[k], 1e-10);
    square[k] = y * y;
    logarithm[k] = std::log(y);
  }
}

/// Fits `count` points, given their abscissas and the results of `fit_weights`. With t the centred and scaled
/// abscissas, z2 is the coefficient of p = t^2 - skewness t - 1, which is orthogonal to 1 and t. The fit is
/// undetermined if the error of the logarithms (`error`) and the rounding of the abscissas to float32 may
/// change z2 by a tenth.
inline GaussianFit fit_gaussian(const double* x, const double* square, const double* logarithm, int count,
                                double error) {
  const auto squared = [](double d) { return d * d; };
  const auto sum = [&](auto&& value) {  // over all points, with their weights
    double total = 0;
    for (int k = 0; k < count; ++k) total += square[k] * value(k);
    return total;
  };

  // All values are relative to the densest point: its weight may exceed others by 20 orders of magnitude.
  const auto densest = std::max_element(square, square + count) - square;
  const auto from_densest = [&](int k) { return x[k] - x[densest]; };
  const auto log_ratio = [&](int k) { return logarithm[k] - logarithm[densest]; };

  // The abscissas t, of mean 0 and variance 1.
  const double weight = sum([](int) { return 1.0; });
  const double mean = sum(from_densest) / weight;
  const double variance = sum([&](int k) { return squared(from_densest(k) - mean); }) / weight;
  if (!(variance > 0)) return {};
  const double inverse = 1 / std::sqrt(variance);
  const auto t = [&](int k) { return (from_densest(k) - mean) * inverse; };

  // The coefficient of p in the logarithms.
  const double skewness = sum([&](int k) { return t(k) * t(k) * t(k); }) / weight;
  const auto p = [&](int k) { return t(k) * t(k) - skewness * t(k) - 1; };
  const double norm = sum([&](int k) { return squared(p(k)); });
  const double bend = sum([&](int k) { return p(k) * log_ratio(k); });

  // The errors of logarithms and abscissas may determine it.
  constexpr double rounding = std::numeric_limits<float>::epsilon();
  const double slope = sum([&](int k) { return t(k) * log_ratio(k); }) / weight;
  const double bend_error = sum([&](int k) {
    const double derivative = slope + (2 * t(k) - skewness) * bend / norm;
    return std::abs(p(k)) * (error + std::abs(derivative * inverse * x[k]) * rounding);
  });
  if (!(norm > 0) || !(bend_error < 0.1 * std::abs(bend))) return {};
  return {bend / norm / variance, true};
}

/// The variance -1 / (2 z2) of a fit. Infinite if the fit is undetermined, or if it is convex and
/// `absolute_curvature` is false.
inline double fitted_variance(const GaussianFit& fit, bool absolute_curvature) {
  const double curvature = absolute_curvature ? -std::abs(fit.curvature) : fit.curvature;
  if (!fit.determined || !(curvature < 0)) return std::numeric_limits<double>::infinity();
  return -0.5 / curvature;
}

/// Fits as the paper's program does, by the normal equations of the raw abscissas. If these equations are
/// nearly linearly dependent, rounding decides the result.
GaussianFit fit_gaussian_as_published(const double* x, const double* square, const double* logarithm,
                                      int count);

}  // namespace slalom::detail
