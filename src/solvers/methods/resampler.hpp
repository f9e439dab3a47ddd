#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "slalom/core/random.hpp"

namespace slalom::detail {

/// Picks samples in proportion to their weights: systematically, at even distances from one random start, or
/// independently.
class Resampler {
 public:
  Resampler(int samples, int most_wanted)
      : running_(static_cast<std::size_t>(samples)),
        cut_(static_cast<std::size_t>(samples) + 1),
        mark_(static_cast<std::size_t>(std::max(samples, most_wanted)) + 1) {}

  /// Picks `wanted` of the samples; weights in [0, 1], not all below 2^-40.
  void pick(const float* weights, int wanted, bool systematic, RandomStream& random, int* indices) noexcept {
    if (systematic) {
      mark_evenly(weights, wanted, random.uniform(), indices);
    } else {
      pick_independently(weights, wanted, random, indices);
    }
  }

 private:
  /// Pick k is the sample whose running sum is the first beyond (k + start) / wanted of the whole, which is
  /// returned. In whole numbers, and without a branch that depends on the weights: each sample marks the pick
  /// at which it would begin, and the last of those that begin at the same pick has it.
  std::int64_t mark_evenly(const float* weights, int wanted, double start, int* indices) noexcept {
    constexpr float unit = 0x1p40f;
    const auto count = static_cast<int>(running_.size());
    std::int64_t sum = 0;
    for (int k = 0; k < count; ++k) sum += static_cast<std::int64_t>(weights[k] * unit);
    const double scale = wanted / static_cast<double>(sum);
    std::fill_n(mark_.begin(), wanted + 1, 0);
    std::int64_t running = 0;
    int begin = 0;
    for (int k = 0; k < count; ++k) {
      const auto weight = static_cast<std::int64_t>(weights[k] * unit);
      running += weight;
      running_[static_cast<std::size_t>(k)] = static_cast<double>(running);
      const double at = static_cast<double>(running) * scale - start;
      const int below = static_cast<int>(at);
      mark_[static_cast<std::size_t>(weight > 0 ? begin : wanted)] = k;
      begin = std::min(below + (at > below), wanted);
    }
    int sample = 0;
    for (int k = 0; k < wanted; ++k) {
      sample = std::max(sample, mark_[static_cast<std::size_t>(k)]);
      indices[k] = sample;
    }
    return sum;
  }

  /// A table of cut points leads to the sample of a number almost without a search.
  void pick_independently(const float* weights, int wanted, RandomStream& random, int* indices) noexcept {
    const auto count = running_.size();
    const std::int64_t whole = mark_evenly(weights, static_cast<int>(count), 0, cut_.data());
    const double sum = static_cast<double>(whole), cuts = static_cast<double>(count);
    for (int k = 0; k < wanted; ++k) {
      const double uniform = static_cast<double>(random()) * 0x1p-32;
      const double at = uniform * sum;
      auto found = static_cast<std::size_t>(cut_[static_cast<std::size_t>(uniform * cuts)]);
      for (int i = 0; i < 2; ++i) found += running_[found] <= at;  // mostly enough, and no branch to guess
      while (found + 1 < count && running_[found] <= at) ++found;
      indices[k] = static_cast<int>(std::min(found, count - 1));
    }
  }

  std::vector<double> running_;
  std::vector<int> cut_, mark_;
};

}  // namespace slalom::detail
