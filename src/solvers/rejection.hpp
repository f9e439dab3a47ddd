#pragma once

#include <algorithm>
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
      entry(1, r) = rejected_mean[r];
      if (!(variance[r] > 0) || !(rejected_variance[r] > 0)) {  // an input that is not sampled has no say
        entry(0, r) = 1;
        entry(2, r) = entry(3, r) = 0;
        continue;
      }
      entry(0, r) = published_density(rejected_mean[r], mean[r], variance[r]);
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

/// Picks samples in proportion to their weights: systematically, at even distances from one random start, or
/// independently. A table of cut points leads to the sample of a number without a search.
class Picker {
 public:
  explicit Picker(int samples)
      : running_(static_cast<std::size_t>(samples)), cut_(static_cast<std::size_t>(samples) + 1) {}

  /// Picks `wanted` of the samples; weights >= 0, not all 0.
  void pick(const float* weights, int wanted, bool systematic, RandomStream& random, int* indices) noexcept {
    const auto count = running_.size();
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) running_[k] = sum += static_cast<double>(weights[k]);
    const double per_cut = sum / static_cast<double>(count);
    std::size_t next = 0;
    for (std::size_t c = 0; c < count; ++c) {  // the first sample whose running sum passes the cut
      while (next + 1 < count && running_[next] <= static_cast<double>(c) * per_cut) ++next;
      cut_[c] = static_cast<int>(next);
    }
    const double start = random.uniform();
    for (int k = 0; k < wanted; ++k) {
      const double uniform = systematic ? (k + start) / wanted : static_cast<double>(random()) * 0x1p-32;
      const double at = uniform * sum;
      auto found = static_cast<std::size_t>(
          cut_[std::min(static_cast<std::size_t>(uniform * static_cast<double>(count)), count - 1)]);
      while (found + 1 < count && running_[found] <= at) ++found;
      indices[k] = static_cast<int>(found);
    }
  }

 private:
  std::vector<double> running_;
  std::vector<int> cut_;
};

}  // namespace slalom::detail
