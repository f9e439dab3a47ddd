#pragma once

#include <cmath>

namespace slalom::detail {

/// One step of mirror descent on the mean m and the standard deviation s of independent Gaussians, towards
/// the mean m_w and the standard deviation s_w of weighted samples (Kobayashi and Fukumoto, "Real-time
/// Sampling-based Model Predictive Control based on Reverse Kullback-Leibler Divergence and Its Adaptive
/// Acceleration", 2022):
///
///     m' = m - eta (m - m_w),   d = -eta (s - s_w),   s' = (d + sqrt(d^2 + 4 s^2)) / 2
///
/// The root keeps s' positive. `step` is eta. All arrays have `rows` entries; variances are s^2. `mean` and
/// `variance` are replaced.
template <class Real>
void mirror_descent(Real step, const Real* weighted_mean, const Real* weighted_variance, int rows, Real* mean,
                    Real* variance) noexcept {
  for (int r = 0; r < rows; ++r) {
    mean[r] = mean[r] - step * (mean[r] - weighted_mean[r]);
    const Real deviation = std::sqrt(variance[r]);
    const Real d = -step * (deviation - std::sqrt(weighted_variance[r]));
    const Real updated = Real(0.5) * (d + std::sqrt(d * d + Real(4) * deviation * deviation));
    variance[r] = updated * updated;
  }
}

/// result = (1 - ratio) from + ratio to. `result` may be `from` or `to`.
template <class Real>
void interpolate(const Real* from, const Real* to, Real ratio, int rows, Real* result) noexcept {
  for (int r = 0; r < rows; ++r) result[r] = (Real(1) - ratio) * from[r] + ratio * to[r];
}

}  // namespace slalom::detail
