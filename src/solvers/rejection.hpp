#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "slalom/core/random.hpp"
#include "solvers/kernels_of.hpp"

/// Which of many samples are kept when a second distribution says where bad ones come from (Kobayashi and
/// Fukumoto 2022).
namespace slalom::detail {

/// What the published program takes for a normal density: exp((x - mean)^2 / deviation) / sqrt(2 pi
/// variance). Its exponent has the wrong sign and scale, so it grows with the distance.
template <class Real>
Real published_density(Real x, Real mean, Real variance) noexcept {
  const Real difference = x - mean;
  return std::exp(difference * (difference / std::sqrt(variance))) /
         std::sqrt(Real(2) * std::numbers::pi_v<Real> * variance);
}

/// The published program's probabilities of keeping samples: prod over rows of 1 / (base + density), where
/// `base` is the density of the samples' distribution at the rejected mean, not at the sample.
template <class Real>
class PublishedRejection {
 public:
  explicit PublishedRejection(int rows) : values_(static_cast<std::size_t>(4 * rows)), rows_(rows) {}

  void set(const Real* mean, const Real* variance, const Real* rejected_mean,
           const Real* rejected_variance) noexcept {
    for (int r = 0; r < rows_; ++r) {
      entry(0, r) = published_density(rejected_mean[r], mean[r], variance[r]);
      entry(1, r) = rejected_mean[r];
      entry(2, r) = Real(1) / std::sqrt(rejected_variance[r]);
      entry(3, r) = Real(1) / std::sqrt(Real(2) * std::numbers::pi_v<Real> * rejected_variance[r]);
    }
  }
  const Real* base() const noexcept { return values_.data(); }
  RejectionRows<Real> rows() const noexcept {
    const Real* v = values_.data();
    return {v, v + rows_, v + 2 * rows_, v + 3 * rows_};
  }

 private:
  Real& entry(int list, int r) noexcept { return values_[static_cast<std::size_t>(list * rows_ + r)]; }

  std::vector<Real> values_;  ///< [base, mean, inverse, scale][row]
  int rows_;
};

/// log of a product of normal densities up to the factor (2 pi)^(-rows/2), of sample k.
template <class Real>
double log_density(const Rows<Real>& v, int k, const Real* mean, const Real* variance) noexcept {
  double sum = 0;
  for (int r = 0; r < v.rows; ++r) {
    const double difference = static_cast<double>(v.row(r)[k]) - static_cast<double>(mean[r]);
    const double s2 = static_cast<double>(variance[r]);
    sum -= 0.5 * (difference * difference / s2 + std::log(s2));
  }
  return sum;
}

/// log of the probability that a sample of the first distribution is kept: p / (p + p_rejected).
inline double log_keep(double log_density_own, double log_density_rejected) noexcept {
  const double ratio = log_density_rejected - log_density_own;
  return ratio > 700 ? -ratio : -std::log1p(std::exp(ratio));
}

}  // namespace slalom::detail
