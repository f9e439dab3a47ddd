#pragma once

#include <vector>

#include "slalom/core/options.hpp"
#include "slalom/core/random.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "solvers/kernels/kernels.hpp"

namespace slalom::detail {

/// Shapes the white normal noise of samples, entry z[t] for step t of an input, before it is scaled by their
/// deviations. Both shapes leave every entry with mean 0 and variance 1, so that Sigma means what it meant.
///
/// *Coloured* (Timmer and Koenig 1995; in sampling-based control: Pinneri et al., "Sample-efficient
/// Cross-Entropy Method for Real-time Planning", CoRL 2020): power 1/f^beta at frequency f, so neighbouring
/// steps move together. A sequence is the first half of a periodic one of N = 2 T steps, lest its end be tied
/// to its start; below the lowest frequency 1/N power stays what it is there:
///
///     c(d) ~ sum_k max(min(k, N - k), 1)^-beta cos(2 pi k d / N),   c(0) = 1,   C[s][t] = c(|s - t|)
///     z <- L z   with   L L^T = C, L lower triangular
///
/// *Normal log-normal* (Mohamed, Yin and Liu, "Autonomous Navigation of AGVs in Unknown Cluttered
/// Environments: log-MPPI Control Strategy", RA-L 2022): z <- z exp(s y - s^2), y standard normal. Its fourth
/// moment is 3 exp(4 s^2): more samples in the tails at the same variance.
class NoiseShape {
 public:
  /// White normal noise, left as it is.
  NoiseShape() = default;
  /// With beta and s per input. Throws std::invalid_argument where a coloured sequence is too long.
  NoiseShape(const PerInput& exponent, const PerInput& log_normal_spread, int steps, int inputs, int samples);

  bool plain() const noexcept { return !coloured_ && spread_.empty(); }
  bool coloured() const noexcept { return coloured_; }

  /// Shapes the samples of a range of `z`, filled with white noise of this key.
  void apply(SequenceBatch& z, Range range, RandomKey key) noexcept;

  /// C^-1 times a sequence [row], in place.
  void whiten_twice(double* sequence) const noexcept;

 private:
  int steps_ = 0;
  int inputs_ = 0;
  bool coloured_ = false;
  std::vector<std::vector<double>> factor_;       ///< L of each input, row by row; empty: white
  std::vector<std::vector<float>> factor_float_;  ///< the same in float32
  std::vector<float> spread_;                     ///< s [row]; empty: normal
  SequenceBatch exponents_;                       ///< y
};

/// c(0) ... c(steps - 1) of noise with power 1/f^exponent.
std::vector<double> coloured_correlation(double exponent, int steps);

}  // namespace slalom::detail
