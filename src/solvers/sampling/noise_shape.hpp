#pragma once

#include <vector>

#include "slalom/core/options.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/solvers/option_groups.hpp"
#include "solvers/kernels/kernels.hpp"

namespace slalom::detail {

/// Shapes the white normal noise of samples before it is scaled by their standard deviations. z[t] is the
/// entry of an input at step t. With either shape, every entry still has mean 0 and variance 1, so that Sigma
/// keeps its meaning.
///
/// *Coloured* (Timmer and Koenig 1995; in sampling-based control: Pinneri et al., "Sample-efficient
/// Cross-Entropy Method for Real-time Planning", CoRL 2020): power 1/f^beta at frequency f, so neighbouring
/// steps are correlated. A sequence is the first half of a periodic one of N = 2 T steps, so that its end is
/// not correlated with its start. Below the lowest frequency 1/N, the power is constant:
///
///     c(d) ~ sum_k max(min(k, N - k), 1)^-beta cos(2 pi k d / N),   c(0) = 1,   C[s][t] = c(|s - t|)
///     z <- L z   with   L L^T = C, L lower triangular
///
/// *Pinned* coloured noise is the coloured noise of T + 1 steps whose first one, that of the input applied
/// before the sequence, is 0: L is that of T + 1 steps without its first row and column. Its variance grows
/// from step to step to about 1. With an exponent above 3 it is smooth, so that a robot whose inputs have
/// limited rates can drive it.
///
/// *Interpolated between knots* (KMPPI of pytorch_mppi, UM-ARM-Lab): n normal values y at knots t_k, evenly
/// over the horizon, and a squared exponential kernel K with the distance of the knots as its length:
///
///     W ~ K(t, t_k) K(t_k, t_k)^-1,   each row of W has length 1,   z = W y,   C = W W^T
///
/// It is also drawn as z <- L z, where W = L Q, Q has orthonormal rows, and L is lower triangular.
class NoiseShape {
 public:
  /// White normal noise.
  NoiseShape() = default;
  /// The number of knots is limited to that of steps. Throws std::invalid_argument if a correlated sequence
  /// is too long, or if noise has both a colour and knots.
  NoiseShape(const NoiseOptions& options, int steps, int inputs);

  /// Whether the noise of any input is correlated along the steps: coloured or interpolated.
  bool correlated() const noexcept { return correlated_; }
  /// Whether it is pinned.
  bool pinned() const noexcept { return pinned_; }

  /// Shapes the samples of a range of `z`, which holds white noise.
  void apply(SequenceBatch& z, Range range) const noexcept;

  /// Multiplies a sequence [row] by C^-1, in place. With knots, C has no inverse, and its pseudo-inverse is
  /// used: only the part of the sequence in which samples differ counts.
  void whiten_twice(double* sequence) const noexcept;

 private:
  void check_length(const char* option) const;
  void colour(const NoiseOptions& options);
  void interpolate(int knots);
  void project_twice(double* sequence, int input) const noexcept;

  int steps_ = 0;
  int inputs_ = 0;
  bool correlated_ = false, pinned_ = false;
  int knots_ = 0;
  std::vector<double> projection_;                ///< W (W^T W)^-1, [step][knot]
  std::vector<std::vector<double>> factor_;       ///< L of each input, row by row; empty: white
  std::vector<std::vector<float>> factor_float_;  ///< the same in float32
};

/// Returns the correlations c(0) ... c(steps - 1) of noise with power 1/f^exponent.
std::vector<double> coloured_correlation(double exponent, int steps);

/// Returns W [step][knot] of noise that is interpolated between knots.
std::vector<double> knot_weights(int steps, int knots);

}  // namespace slalom::detail
