#pragma once

#include <algorithm>
#include <cmath>

#include "solvers/kernels/kernels.hpp"

/// Stein variational gradient descent (Liu and Wang, NeurIPS 2016): particles x_i move along
///
///     phi(x_i) = 1/n sum_j [ k(x_j, x_i) g_j + grad_{x_j} k(x_j, x_i) ],   k(a, b) = exp(-|a - b|^2 / h)
///     grad_{x_j} k = -2/h k (x_j - x_i)
///
/// with g_j the gradient of the log posterior at x_j: `Kernels::stein_directions`. This file has the
/// bandwidth h.
namespace slalom::detail {

inline constexpr double least_bandwidth = 1e-5;

/// h = median / log n of the values given, which are reordered; the median is element count/2 of the sorted
/// ones, h is at least 1e-5. `particles` is n.
template <class Real>
Real bandwidth(Real* values, int count, int particles) noexcept {
  Real* middle = values + count / 2;
  std::nth_element(values, middle, values + count);
  const Real h = *middle / std::log(static_cast<Real>(particles));
  const Real least = static_cast<Real>(least_bandwidth);
  return h > least ? h : least;
}

/// Squared distances between pairs of at most 64 particles, evenly picked: their median estimates that of all
/// pairs at a fraction of the cost. Returns how many; `values` holds 2016 or fewer.
template <class Real>
int pair_distances(const Rows<Real>& x, int count, Real* values) noexcept {
  const int picked = std::min(count, 64);
  int pairs = 0;
  for (int a = 0; a < picked; ++a) {
    for (int b = a + 1; b < picked; ++b) {
      const int i = static_cast<int>(static_cast<long long>(a) * count / picked);
      const int j = static_cast<int>(static_cast<long long>(b) * count / picked);
      Real distance = 0;
      for (int r = 0; r < x.rows; ++r) {
        const Real d = x.row(r)[i] - x.row(r)[j];
        distance += d * d;
      }
      values[pairs++] = distance;
    }
  }
  return pairs;
}

/// Gradient of the log of a Gaussian prior at x, an entry of it: -Sigma^-1 (x - m).
template <class Real>
Real prior_gradient(Real x, Real mean, Real inverse_variance) noexcept {
  return -inverse_variance * (x - mean);
}

}  // namespace slalom::detail
