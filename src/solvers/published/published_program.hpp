#pragma once

#include <cmath>
#include <numbers>

#include "solvers/kernels/kernels.hpp"

/// Differences of the published program of Honda et al. (ICRA 2024) in the rejection of samples and in Stein
/// variational MPC.
namespace slalom::detail {

/// The published program's density in place of the normal one: exp((x - mean)^2 / deviation) / sqrt(2 pi
/// variance). Its exponent has the wrong sign and scale, so it grows with the distance.
inline float published_density(float x, float mean, float variance) noexcept {
  const float difference = x - mean;
  return std::exp(difference * (difference / std::sqrt(variance))) /
         std::sqrt(2.0f * std::numbers::pi_v<float> * variance);
}

/// The published program's probabilities of keeping samples: prod over rows of 1 / (base + density), where
/// `base` is the density of the samples' distribution at the rejected mean, not at the sample.
class PublishedRejection {
 public:
  explicit PublishedRejection(int rows) : values_(4, rows), rows_(rows) {}

  void set(const float* mean, const float* variance, const float* rejected_mean,
           const float* rejected_variance) noexcept {
    for (int r = 0; r < rows_; ++r) {
      values_[1][r] = rejected_mean[r];
      if (!(variance[r] > 0) || !(rejected_variance[r] > 0)) {  // an input that is not sampled has no effect
        values_[0][r] = 1;
        values_[2][r] = values_[3][r] = 0;
        continue;
      }
      values_[0][r] = published_density(rejected_mean[r], mean[r], variance[r]);
      values_[2][r] = 1.0f / std::sqrt(rejected_variance[r]);
      values_[3][r] = 1.0f / std::sqrt(2.0f * std::numbers::pi_v<float> * rejected_variance[r]);
    }
  }
  const float* base() const noexcept { return values_[0]; }
  RejectionRows rows() const noexcept { return {values_[0], values_[1], values_[2], values_[3]}; }

 private:
  Matrix<float> values_;  ///< [base, mean, inverse, scale][row]
  int rows_;
};

/// Squared norms of the particles, from which the program takes its bandwidth. Returns their number.
inline int squared_norms(const Rows& x, int count, float* values) noexcept {
  for (int i = 0; i < count; ++i) {
    values[i] = 0;
    for (int r = 0; r < x.rows; ++r) values[i] += x.row(r)[i] * x.row(r)[i];
  }
  return count;
}

/// The program's gradient of the log of a Gaussian prior: with the variance inverted twice, wrongly signed.
inline float published_prior_gradient(float x, float mean, float inverse_variance) noexcept {
  return (x - mean) / inverse_variance;
}

}  // namespace slalom::detail
