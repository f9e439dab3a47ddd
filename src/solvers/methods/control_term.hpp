#pragma once

namespace slalom::detail {

/// 1 / variance + offset; without a variance there is nothing to weigh and it is 0.
template <class Real>
Real inverse_variance(Real variance, Real offset) noexcept {
  return variance > 0 ? Real(1) / variance + offset : Real(0);
}

/// Coefficients [row] of the control term, sum_row coefficient v = lambda (1 - alpha) sum_t (u - n)^T
/// Sigma^-1 v (Honda et al., ICRA 2024, equation (8), which has no alpha): u the mean of the samples, n
/// the nominal.
template <class Real>
void control_coefficients(double temperature, double discount, double inverse_variance_offset,
                          const Real* mean, const Real* nominal, const Real* variance, int rows,
                          Real* coefficients) noexcept {
  const double factor = temperature * (1.0 - discount);
  for (int r = 0; r < rows; ++r) {
    coefficients[r] =
        static_cast<Real>(factor * (static_cast<double>(mean[r]) - static_cast<double>(nominal[r])) *
                          inverse_variance(static_cast<double>(variance[r]), inverse_variance_offset));
  }
}

}  // namespace slalom::detail
