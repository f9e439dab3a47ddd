#pragma once

namespace slalom::detail {

/// 1 / variance + offset; 0 for an input that is not sampled (variance 0).
template <class Real>
Real inverse_variance(Real variance, Real offset) noexcept {
  return variance > 0 ? Real(1) / variance + offset : Real(0);
}

/// Coefficients [row] of the control term (Honda et al., ICRA 2024, equation (8), where alpha = 0):
///
///     sum_row coefficient v = lambda (1 - alpha) sum_t (u - n)^T Sigma^-1 v
///
/// `temperature` is lambda, `discount` is alpha, `mean` is the samples' mean u and `nominal` is the nominal
/// sequence n. All arrays have `rows` values.
template <class Real>
void control_coefficients(double temperature, double discount, double inverse_variance_offset,
                          const Real* mean, const Real* nominal, const Real* variance, int rows,
                          Real* coefficients) noexcept {
  const double factor = temperature * (1.0 - discount);
  for (int r = 0; r < rows; ++r) {
    const double u = mean[r], n = nominal[r];
    const double inverse = inverse_variance<double>(variance[r], inverse_variance_offset);
    coefficients[r] = static_cast<Real>(factor * (u - n) * inverse);
  }
}

}  // namespace slalom::detail
