#pragma once

#include "solvers/kernels/kernels.hpp"

/// Where the published program of Honda et al. (ICRA 2024) differs in Stein variational MPC.
namespace slalom::detail {

/// Squared norms of the particles, from which the program takes its bandwidth. Returns their number.
template <class Real>
int squared_norms(const Rows<Real>& x, int count, Real* values) noexcept {
  for (int i = 0; i < count; ++i) {
    values[i] = 0;
    for (int r = 0; r < x.rows; ++r) values[i] += x.row(r)[i] * x.row(r)[i];
  }
  return count;
}

/// The program's gradient of the log of a Gaussian prior: with the inverse of the inverse variance, and the
/// wrong sign.
template <class Real>
Real published_prior_gradient(Real x, Real mean, Real inverse_variance) noexcept {
  return (x - mean) / inverse_variance;
}

}  // namespace slalom::detail
