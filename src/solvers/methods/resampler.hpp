#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/random.hpp"

namespace slalom::detail {

/// Resamples: selects samples with probabilities proportional to their weights. Systematic resampling uses
/// equidistant points from one random start; the alternative draws independently.
class Resampler {
 public:
  Resampler(int samples, int max_resampled)
      : running_(samples), cut_(samples + 1), mark_(std::max(samples, max_resampled) + 1) {}

  /// Selects `wanted` samples (with repetition) and writes their indices. Weights are in [0, 1], and at least
  /// one is 2^-40 or more.
  void pick(const float* weights, int wanted, bool systematic, RandomStream& random, int* indices) noexcept {
    if (systematic) {
      mark_evenly(weights, wanted, random.uniform(), indices);
    } else {
      pick_independently(weights, wanted, random, indices);
    }
  }

 private:
  /// Selection k is the first sample whose running sum exceeds (k + start) / wanted of the total. Returns the
  /// total, in units of 2^-40. Sums are integers, and no branch depends on the weights: each sample marks the
  /// first selection that it could have, and the last sample with the same mark has it.
  std::int64_t mark_evenly(const float* weights, int wanted, double start, int* indices) noexcept {
    constexpr float unit = 0x1p40f;
    const auto count = static_cast<int>(running_.size());
    std::int64_t sum = 0;
    for (int k = 0; k < count; ++k) sum += saturate_cast<std::int64_t>(weights[k] * unit);
    const double scale = wanted / static_cast<double>(sum);
    std::fill_n(mark_.begin(), wanted + 1, 0);
    std::int64_t running = 0;
    int begin = 0;
    for (int k = 0; k < count; ++k) {
      const auto weight = saturate_cast<std::int64_t>(weights[k] * unit);
      running += weight;
      running_[k] = running;
      const double at = running_[k] * scale - start;
      const int below = static_cast<int>(at);
      mark_[weight > 0 ? begin : wanted] = k;
      begin = std::min(below + (at > below), wanted);
    }
    int sample = 0;
    for (int k = 0; k < wanted; ++k) {
      sample = std::max(sample, mark_[k]);
      indices[k] = sample;
    }
    return sum;
  }

  /// Draws samples independently. A table of cut points makes the search of a sample short.
  void pick_independently(const float* weights, int wanted, RandomStream& random, int* indices) noexcept {
    const auto count = static_cast<int>(running_.size());
    const double sum = mark_evenly(weights, count, 0, cut_.data());
    for (int k = 0; k < wanted; ++k) {
      const double uniform = random() * 0x1p-32;
      const double at = uniform * sum;
      int found = cut_[saturate_cast<int>(uniform * count)];
      for (int i = 0; i < 2; ++i) found += running_[found] <= at;  // usually sufficient, and without a branch
      while (found + 1 < count && running_[found] <= at) ++found;
      indices[k] = std::min(found, count - 1);
    }
  }

  std::vector<double> running_;  ///< running sums of the weights [sample]
  std::vector<int> cut_;         ///< the first sample beyond k / samples of the total
  std::vector<int> mark_;        ///< the last sample that begins at a selection
};

}  // namespace slalom::detail
