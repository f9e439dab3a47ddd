#pragma once

#include <cstdint>
#include <vector>

namespace slalom::detail {

/// The deviations of fine samples, which make a plan exact (docs/algorithms/svg-mppi.md):
///
///     v = p + a s e^x D0 z,   a <- 1.3 a if they improved the plan, else 0.7 a
///
/// D0 are the first deviations, z is noise, x is in [-0.7, 0.7] and differs from sample to sample. s [row],
/// whose geometric mean is 1, follows the deviations of the weighted samples: where the end of the horizon
/// may still change, its start is already exact. a and s stay from solve to solve; s is a function of the
/// position in the horizon and does not move with the plan.
class FineNoise {
 public:
  static constexpr double share = 0.4;   ///< fraction of a batch's samples that are fine
  static constexpr double white = 0.25;  ///< share of them that have white noise

  /// `first_variance` is D0^2 [row].
  explicit FineNoise(const std::vector<float>& first_variance);

  /// Forgets all solves.
  void reset() noexcept;
  /// D0 [row].
  const std::vector<float>& first_deviation() const noexcept { return first_; }
  /// The deviations a s D0 of the next batch, at most D0 [row].
  const std::vector<float>& deviation() noexcept;
  /// The factor e^x of sample `index`.
  static float spread(std::int64_t index) noexcept;
  /// Fits the scale a to whether the last samples improved the plan.
  void learn_scale(bool improved) noexcept;
  /// Fits the shape s to the sums of weighted squares [row] of the last samples.
  void learn_shape(const std::vector<double>& squares) noexcept;

 private:
  double scale_ = 1;
  std::vector<float> first_, shape_, deviation_;  ///< [row]
};

}  // namespace slalom::detail
