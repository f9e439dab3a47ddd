#pragma once

#include <cmath>

namespace slalom::detail {

/// One step of mirror descent on the mean m and the standard deviation s of independent Gaussians, towards
/// the mean m_w and the standard deviation s_w of weighted samples (Kobayashi and Fukumoto, "float-time
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
