#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "solvers/sampling/sample_set.hpp"
#include "solvers/sampling/seek_temperature.hpp"

namespace slalom::detail {

/// The source, the scale and the colour of each sample of a `Mixture`.
class SampleKinds {
 public:
  /// If `mixes_colours` is false, all noise has the shape of the set.
  SampleKinds(int stride, bool mixes_colours)
      : source_(stride), scale_(stride), white_(stride), mixes_colours_(mixes_colours) {}

  /// Gives the samples `first` to `end` a source, and white noise to the fraction `white` of them, evenly.
  /// `offset` varies which ones.
  void mark(int first, int end, int source, double white, std::int64_t offset) noexcept {
    for (int k = first; k < end; ++k) {
      const double i = static_cast<double>(k - first + offset % 64);
      source_[k] = static_cast<float>(source);
      scale_[k] = 1;
      white_[k] = mixes_colours_ && std::floor((i + 1) * white) > std::floor(i * white);
    }
  }
  /// The factor of the deviations of a sample.
  float& scale(int sample) noexcept { return scale_[sample]; }
  /// Whether the noise of a sample is white.
  bool white(int sample) const noexcept { return white_[sample] > 0; }

  /// The samples as draws from `sources`, within the bounds [row].
  Mixture of(std::span<const Mixture::Source> sources, const float* low, const float* high) const noexcept {
    return {sources, source_.data(), scale_.data(), white_.data(), low, high};
  }

 private:
  AlignedBuffer source_, scale_, white_;  ///< [sample]
  bool mixes_colours_;
};

/// Weighs the samples `first` to `end` of a set, and the others with 0. The weights sum to 1. Their effective
/// sample size is `effective`, for which `temperature` is sought from its last value, unless a temperature is
/// `given` (above 0). Returns the sums of the weights before they were normalised; without a finite cost all
/// are 0.
inline WeightSums<double> weigh_part(SampleSet& set, int first, int end, double effective, double given,
                                     double& temperature) noexcept {
  const float* const costs = set.costs().data();
  const float least = first < end ? *std::min_element(costs + first, costs + end) : INFINITY;
  if (!std::isfinite(least)) {
    std::fill(set.weights().begin(), set.weights().end(), 0.0f);
    return {};
  }
  float* const totals = set.totals().data();
  std::fill_n(totals, set.stride(), INFINITY);
  std::copy(costs + first, costs + end, totals + first);
  WeightSums<double> all;
  const Range range{0, set.stride()};
  const auto weigh_at = [&](double value) {
    const WeightSums<float> sums = kernels::exponential_weights(
        totals, costs, least, static_cast<float>(value), range, set.weights().data());
    all = {sums.weight, sums.squared, sums.cost};
    return all.effective();
  };
  const double excess = mean_excess({totals + first, totals + end}, least);
  if (given > 0) {
    temperature = given;
  } else {
    temperature = excess > 0 ? seek_temperature(std::max(effective, 1.0), excess, temperature, weigh_at) : 1;
  }
  weigh_at(temperature);
  kernels::scale(static_cast<float>(1 / all.weight), range, set.weights().data());
  return all;
}

}  // namespace slalom::detail
