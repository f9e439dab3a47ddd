#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/kernels/kernels.hpp"

namespace slalom::detail {

/// The gradient of log E[w] at a particle theta, estimated from samples v_i ~ N(theta, Sigma_g) without
/// derivatives of the cost (Lambert et al., "Stein Variational Model Predictive Control", CoRL 2020; Honda et
/// al., ICRA 2024, equation (11)):
///
///     g = sum_i w_i Sigma_g^-1 (v_i - theta) / (sum_i w_i + floor),   w_i = exp(-J_i / lambda)
///
/// J is the cost S with the terms that the method adds to it. With `subtract_minimum`, w_i = exp(-(J_i - min
/// J) / lambda); this makes a difference only if the floor is not 0. Without it, the floor stops a particle
/// whose samples are all bad. The weights are computed relative to the minimum in both cases, so that they do
/// not all underflow; the floor is scaled accordingly.
template <class Real>
struct SurrogateGradient {
  Real temperature = 1;                    ///< lambda
  bool subtract_minimum = true;            ///< whether the weights are relative to the lowest J
  double floor = 0;                        ///< added to the sum of the weights
  const Real* centre = nullptr;            ///< theta [row]
  const Real* inverse_variance = nullptr;  ///< inverse variances of the samples, [row]
  const Real* linear = nullptr;            ///< J += sum linear[row] v[row]; may be null
  const Real* distance_centre = nullptr;   ///< J += sum distance_weight (v - distance_centre)^2; may be null
  const Real* distance_weight = nullptr;   ///< [row]
};

/// Computes the gradient g [row] from the first `samples` samples of the range `block` of `v`. `block.count`
/// is a multiple of the lanes. `totals` holds the costs S and is replaced by J. `weights` is scratch memory
/// of the same length. Returns false, with g = 0, if no J is finite.
template <class Real>
bool surrogate_gradient(const SurrogateGradient<Real>& s, const Rows<Real>& v, Range block, int samples,
                        Real* totals, Real* weights, Real* gradient) noexcept {
  const Kernels<Real>& k = kernels<Real>();
  constexpr Real infinite = std::numeric_limits<Real>::infinity();
  if (s.linear) k.add_linear(v, s.linear, block, totals);
  if (s.distance_centre) k.add_squared_distance(v, s.distance_centre, s.distance_weight, block, totals);
  k.make_finite(block, totals);
  std::fill(totals + block.first + samples, totals + block.first + block.count, infinite);
  const Real least = k.minimum(totals, block);
  if (!(least < infinite)) {
    std::fill_n(gradient, v.rows, Real(0));
    return false;
  }
  const double sum = k.exponential_weights(totals, totals, least, s.temperature, block, weights).weight;
  const double temperature = s.temperature;
  const double floor = s.subtract_minimum ? s.floor : s.floor * std::exp(least / temperature);
  k.weighted_sums(v, weights, s.centre, block, gradient);
  for (int r = 0; r < v.rows; ++r) {
    const double moved = gradient[r];
    gradient[r] = static_cast<Real>(s.inverse_variance[r] * moved / (sum + floor));
  }
  return true;
}

}  // namespace slalom::detail
