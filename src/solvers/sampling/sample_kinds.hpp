#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "solvers/sampling/sample_set.hpp"

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

}  // namespace slalom::detail
