#pragma once

#include "solvers/kernels/kernels.hpp"

/// Differences of the published program of Honda et al. (ICRA 2024) in Stein variational MPC.
namespace slalom::detail {

/// Squared norms of the particles, from which the program takes its bandwidth. Returns their number.
inline int squared_norms(const Rows& x, int count, float* values) noexcept {
  for (int i = 0; i < count; ++i) {
    values[i] = 0;
    for (int r = 0; r < x.rows; ++r) values[i] += x.row(r)[i] * x.row(r)[i];
  }
  return count;
}

/// The program's gradient of the log of a Gaussian prior: with the inverse of the inverse variance, and the
/// wrong sign.
inline float published_prior_gradient(float x, float mean, float inverse_variance) noexcept {
  return (x - mean) / inverse_variance;
}

}  // namespace slalom::detail
