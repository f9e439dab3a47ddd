#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/kernels/kernels.hpp"

namespace slalom::detail {

/// Sums of the reverse weights of a set of samples.
struct ReverseSums {
  double evaluated = 0;   ///< sum of the positive parts before they are normalised
  double rejected = 0;    ///< sum of the negative parts
  double log_growth = 0;  ///< log of sum exp((J - min J) / lambda); above 709 the sum overflows `double`
  bool usable = false;    ///< whether some J is finite
};

/// Mode-seeking weights (Kobayashi and Fukumoto 2022): good samples attract, bad ones repel.
///
///     p_k = exp(-(J_k - min J) / lambda) / (sum + offset)
///     n_k = ratio exp((J_k - min J) / lambda) / (sum + offset)
///     evaluated_k = max(p_k - n_k, 0) / sum,   rejected_k = max(n_k - p_k, 0) / sum
///
/// The growing exponentials are relative to the largest J, so that they cannot overflow. A sample whose J is
/// not finite has weight 0 in both. If a sum is 0, its weights remain 0. `range` starts at 0 and is a
/// multiple of the lanes; J is infinite in the padding. Arrays are [sample].
template <class Real>
ReverseSums reverse_weights(const Real* totals, Real temperature, Real ratio, Real offset, Range range,
                            Real* evaluated, Real* rejected) noexcept {
  const Kernels<Real>& kernel_set = kernels<Real>();
  constexpr Real infinite = std::numeric_limits<Real>::infinity();
  const int end = range.first + range.count;
  ReverseSums sums;
  const Real least = kernel_set.minimum(totals, range);
  std::fill(evaluated + range.first, evaluated + end, Real(0));
  std::fill(rejected + range.first, rejected + end, Real(0));
  if (!(least < infinite)) return sums;
  sums.usable = true;
  const Real falling =
      kernel_set.exponential_weights(totals, totals, least, temperature, range, evaluated).weight + offset;
  // exp((J - max) / lambda) = exp((min' - J') / lambda) with J' = -J.
  for (int k = range.first; k < end; ++k) rejected[k] = totals[k] < infinite ? -totals[k] : infinite;
  const Real most = kernel_set.minimum(rejected, range);
  Real growing =
      kernel_set.exponential_weights(rejected, rejected, most, temperature, range, rejected).weight;
  const Real spread = (-most - least) / temperature;
  sums.log_growth = spread + std::log(growing);
  growing += offset * std::exp(-spread);
  const WeightSums<Real> parts =
      kernel_set.split_weights(falling, growing / ratio, range, evaluated, rejected);
  sums.evaluated = parts.weight;
  sums.rejected = parts.squared;
  if (sums.evaluated > 0) kernel_set.scale(static_cast<Real>(1 / sums.evaluated), range, evaluated);
  if (sums.rejected > 0) kernel_set.scale(static_cast<Real>(1 / sums.rejected), range, rejected);
  return sums;
}

}  // namespace slalom::detail
