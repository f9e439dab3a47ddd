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
inline ReverseSums reverse_weights(const float* totals, float temperature, float ratio, float offset,
                                   Range range, float* evaluated, float* rejected) noexcept {
  constexpr float infinite = std::numeric_limits<float>::infinity();
  const int end = range.first + range.count;
  ReverseSums sums;
  const float least = kernels::minimum(totals, range);
  std::fill(evaluated + range.first, evaluated + end, 0.0f);
  std::fill(rejected + range.first, rejected + end, 0.0f);
  if (!(least < infinite)) return sums;
  const float falling =
      kernels::exponential_weights(totals, totals, least, temperature, range, evaluated).weight + offset;
  // exp((J - max) / lambda) = exp((min' - J') / lambda) with J' = -J.
  for (int k = range.first; k < end; ++k) rejected[k] = totals[k] < infinite ? -totals[k] : infinite;
  const float most = kernels::minimum(rejected, range);
  float growing = kernels::exponential_weights(rejected, rejected, most, temperature, range, rejected).weight;
  const float spread = (-most - least) / temperature;
  sums.log_growth = spread + std::log(growing);
  growing += offset * std::exp(-spread);
  const WeightSums<float> parts =
      kernels::split_weights(falling, growing / ratio, range, evaluated, rejected);
  sums.evaluated = parts.weight;
  sums.rejected = parts.squared;
  if (sums.evaluated > 0) kernels::scale(static_cast<float>(1 / sums.evaluated), range, evaluated);
  if (sums.rejected > 0) kernels::scale(static_cast<float>(1 / sums.rejected), range, rejected);
  return sums;
}

/// One step of mirror descent on the mean m and the standard deviation s of independent Gaussians, towards
/// the mean m_w and the standard deviation s_w of weighted samples (Kobayashi and Fukumoto, "Real-time
/// Sampling-based Model Predictive Control based on Reverse Kullback-Leibler Divergence and Its Adaptive
/// Acceleration", 2022):
///
///     m' = m - eta (m - m_w),   d = -eta (s - s_w),   s' = (d + sqrt(d^2 + 4 s^2)) / 2
///
/// The root keeps s' positive. `step` is eta. All arrays have `rows` entries; variances are s^2. `mean` and
/// `variance` are replaced.
inline void mirror_descent(float step, const float* weighted_mean, const float* weighted_variance, int rows,
                           float* mean, float* variance) noexcept {
  for (int r = 0; r < rows; ++r) {
    mean[r] = mean[r] - step * (mean[r] - weighted_mean[r]);
    const float deviation = std::sqrt(variance[r]);
    const float d = -step * (deviation - std::sqrt(weighted_variance[r]));
    const float updated = 0.5f * (d + std::sqrt(d * d + 4.0f * deviation * deviation));
    variance[r] = updated * updated;
  }
}

/// result = (1 - ratio) from + ratio to. `result` may be `from` or `to`.
inline void interpolate(const float* from, const float* to, float ratio, int rows, float* result) noexcept {
  for (int r = 0; r < rows; ++r) result[r] = (1.0f - ratio) * from[r] + ratio * to[r];
}

}  // namespace slalom::detail
