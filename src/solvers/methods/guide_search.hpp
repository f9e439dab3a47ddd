#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace slalom::detail {

/// Moves a share towards 1 if its samples won, else towards 0, but not below `least` and above 1 - `least`.
inline void learn_share(double& share, bool won, double least) noexcept {
  constexpr double rate = 0.2;  ///< weight of a batch
  share = std::clamp(share + rate * (won - share), least, 1 - least);
}

/// A guide of `svg_mppi` in batches: a search for a mode. Its deviations D are wide at the start of every
/// solve and narrow within it:
///
///     v = m + D z,   m <- sum w v,   D^2 <- 0.9 sum w (v - m)^2 + 0.1 D^2
///
/// The share of its samples that have white noise follows from the colour of the best ones.
struct GuideSearch {
  static constexpr double effective_share = 0.7;  ///< effective size of its samples / sqrt(their number)

  std::vector<float> variance, deviation;  ///< D^2, D [row]
  double temperature = 0;                  ///< that of the last weights; 0 before the first ones
  double white = 0.5;                      ///< share of its samples that have white noise
  int first = 0, end = 0;                  ///< its samples in the present batch

  bool has_samples() const noexcept { return first < end; }

  /// Forgets all solves.
  void reset() noexcept {
    temperature = 0;
    white = 0.5;
  }
  /// The colour of the best sample of a batch.
  void learn_colour(bool best_is_white) noexcept { learn_share(white, best_is_white, 0.05); }
  /// Moves the variance towards `squares` [row], those of the weighted samples around their mean.
  void narrow(const std::vector<double>& squares, const std::vector<float>& first_variance) noexcept {
    constexpr float kept = 0.1f, least = 1e-4f;
    for (std::size_t r = 0; r < variance.size(); ++r) {
      const float found = static_cast<float>(squares[r]);
      variance[r] = std::max(found + kept * (variance[r] - found), least * first_variance[r]);
    }
  }
  /// Sets D from D^2.
  const float* deviations() noexcept {
    for (std::size_t r = 0; r < variance.size(); ++r) deviation[r] = std::sqrt(variance[r]);
    return deviation.data();
  }
};

}  // namespace slalom::detail
