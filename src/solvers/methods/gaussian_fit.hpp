#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

/// A Gaussian fitted to points of its density (Guo, "A Simple Algorithm for Fitting a Gaussian Function",
/// IEEE Signal Processing Magazine 28(5), 2011; Honda et al., ICRA 2024, equation (13)):
/// ln y = z0 + z1 x + z2 x^2 is fitted by least squares with weight y^2 for each point, in double precision.
namespace slalom::detail {

/// The result of a fit.
struct GaussianFit {
  double curvature = 0;     ///< z2, which is -1 / (2 variance) for a Gaussian; 0 if undetermined
  bool determined = false;  ///< whether the points determine the curvature
};

/// The squares and logarithms of the densities of `count` points. Densities below 1e-10 count as 1e-10.
inline void fit_weights(const double* density, int count, double* square, double* logarithm) {
  for (int k = 0; k < count; ++k) {
    const double y = std::max(density[k], 1e-10);
    square[k] = y * y;
    logarithm[k] = std::log(y);
  }
}

/// Fits `count` points, given their abscissas and the results of `fit_weights`. With t the centred and scaled
/// abscissas, z2 is the coefficient of p = t^2 - skewness t - 1, which is orthogonal to 1 and t. The fit is
/// undetermined if `error`, of the logarithms, and the rounding of the abscissas to float32 may change z2 by
/// a tenth.
inline GaussianFit fit_gaussian(const double* x, const double* square, const double* logarithm, int count,
                                double error) {
  constexpr double rounding = std::numeric_limits<float>::epsilon();
  const auto sum = [&](auto&& value) {
    double total = 0;
    for (int k = 0; k < count; ++k) total += square[k] * value(k);
    return total;
  };
  // Relative to the densest point, whose weight may exceed that of the others by 20 orders of magnitude.
  int densest = 0;
  for (int k = 1; k < count; ++k)
    if (square[k] > square[densest]) densest = k;
  const auto from_densest = [&](int k) { return x[k] - x[densest]; };
  const auto log_ratio = [&](int k) { return logarithm[k] - logarithm[densest]; };
  const double weight = sum([](int) { return 1.0; });
  const double mean = sum(from_densest) / weight;
  const auto squared = [](double d) { return d * d; };
  const double variance = sum([&](int k) { return squared(from_densest(k) - mean); }) / weight;
  if (!(variance > 0)) return {};
  const double scale = std::sqrt(variance), inverse = 1 / scale;
  const auto t = [&](int k) { return (from_densest(k) - mean) * inverse; };
  const double skewness = sum([&](int k) { return t(k) * t(k) * t(k); }) / weight;
  const double slope = sum([&](int k) { return t(k) * log_ratio(k); }) / weight;
  const auto p = [&](int k) { return t(k) * t(k) - skewness * t(k) - 1; };
  const double norm = sum([&](int k) { return squared(p(k)); });
  const double bend = sum([&](int k) { return p(k) * log_ratio(k); });
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

using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Solves the normal equations A z = b for z2 by QR with column pivoting. A column counts as dependent, with
/// coefficient 0, if only rounding error of it is left: norm^2 < (eps * largest initial norm)^2 * remaining
/// rows / rows. This is the rule of Eigen 3.4, which the paper's authors use.
inline GaussianFit solve_normal_equations(Matrix3 a, std::array<double, 3> b) {
  constexpr int n = 3;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  std::array<double, n> norm{}, direct_norm{}, diagonal{};
  std::array<int, n> column{0, 1, 2};
  double largest = 0;
  for (int j = 0; j < n; ++j) {
    norm[j] = direct_norm[j] = std::sqrt(a[0][j] * a[0][j] + a[1][j] * a[1][j] + a[2][j] * a[2][j]);
    largest = std::max(largest, norm[j]);
  }
  const double threshold = (largest * eps) * (largest * eps) / n;
  const double downdate_limit = std::sqrt(eps);
  int pivots = n;
  for (int k = 0; k < n; ++k) {
    int best = k;
    for (int j = k + 1; j < n; ++j)
      if (norm[j] > norm[best]) best = j;
    if (pivots == n && norm[best] * norm[best] < threshold * (n - k)) pivots = k;
    if (best != k) {
      for (int i = 0; i < n; ++i) std::swap(a[i][k], a[i][best]);
      std::swap(norm[k], norm[best]);
      std::swap(direct_norm[k], direct_norm[best]);
      std::swap(column[k], column[best]);
    }
    // Householder reflection of the rest of column k, applied to the columns after it and to b.
    double tail = 0;
    for (int i = k + 1; i < n; ++i) tail += a[i][k] * a[i][k];
    double tau = 0, beta = a[k][k];
    std::array<double, n> v{};
    if (tail > std::numeric_limits<double>::min()) {
      beta = std::sqrt(a[k][k] * a[k][k] + tail);
      if (a[k][k] >= 0) beta = -beta;
      for (int i = k + 1; i < n; ++i) v[i] = a[i][k] / (a[k][k] - beta);
      tau = (beta - a[k][k]) / beta;
    }
    v[k] = 1;
    diagonal[k] = beta;
    for (int j = k + 1; j < n; ++j) {
      double product = 0;
      for (int i = k; i < n; ++i) product += v[i] * a[i][j];
      for (int i = k; i < n; ++i) a[i][j] -= tau * v[i] * product;
    }
    double product = 0;
    for (int i = k; i < n; ++i) product += v[i] * b[i];
    for (int i = k; i < n; ++i) b[i] -= tau * v[i] * product;
    a[k][k] = beta;
    // Update the norms of the remaining columns; recompute a norm if the update has lost its digits.
    for (int j = k + 1; j < n; ++j) {
      if (norm[j] == 0) continue;
      const double ratio = std::abs(a[k][j]) / norm[j];
      const double left = std::max((1 + ratio) * (1 - ratio), 0.0);
      const double relative = norm[j] / direct_norm[j];
      if (left * relative * relative <= downdate_limit) {
        double square = 0;
        for (int i = k + 1; i < n; ++i) square += a[i][j] * a[i][j];
        norm[j] = direct_norm[j] = std::sqrt(square);
      } else {
        norm[j] *= std::sqrt(left);
      }
    }
  }
  std::array<double, n> z{};
  for (int i = pivots - 1; i >= 0; --i) {
    double rest = b[i];
    for (int j = i + 1; j < pivots; ++j) rest -= a[i][j] * z[j];
    z[i] = rest / diagonal[i];
  }
  for (int i = 0; i < pivots; ++i)
    if (column[i] == 2) return {z[i], z[i] != 0};
  return {};
}

/// Fits as the paper's program does: by normal equations of the abscissas as they are. Where these are nearly
/// dependent, rounding decides the result.
inline GaussianFit fit_gaussian_as_published(const double* x, const double* square, const double* logarithm,
                                             int count) {
  Matrix3 a{};
  std::array<double, 3> b{};
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < 3; ++i) {
      double power = square[k];
      for (int p = 0; p < i; ++p) power *= x[k];
      b[i] += power * logarithm[k];
      for (int j = 0; j < 3; ++j) {
        a[i][j] += power;
        power *= x[k];
      }
    }
  }
  return solve_normal_equations(a, b);
}

/// The same, given abscissas and densities.
inline GaussianFit fit_gaussian_as_published(const std::vector<double>& x,
                                             const std::vector<double>& density) {
  std::vector<double> square(x.size()), logarithm(x.size());
  const auto count = static_cast<int>(x.size());
  fit_weights(density.data(), count, square.data(), logarithm.data());
  return fit_gaussian_as_published(x.data(), square.data(), logarithm.data(), count);
}

}  // namespace slalom::detail
