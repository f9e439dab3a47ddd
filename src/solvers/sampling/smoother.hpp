#pragma once

#include <vector>

#include "solvers/kernels/kernels.hpp"

namespace slalom::detail {

/// Smooths a control sequence (Savitzky and Golay 1964; in MPPI: Williams et al. 2018): every entry is
/// replaced by the value of the polynomial that best fits the entries in a window around it. At the ends,
/// where the window cannot be centred, the first or last complete window is used. A polynomial of the degree
/// does not change.
///
/// With p_0 ... p_d orthonormal polynomials over a window of w entries, entry e of the fit is
/// sum_j H[e][j] u[j], H[e][j] = sum_i p_i(e) p_i(j).
class Smoother {
 public:
  /// A smoother that does not change sequences.
  Smoother() = default;
  /// Fits a polynomial of at most `degree` in a window of 2 half_width + 1 entries, or of all `steps` if they
  /// are fewer.
  Smoother(int steps, int inputs, int half_width, int degree);

  /// Whether `apply` changes sequences.
  bool active() const noexcept { return window_ > 1; }

  /// Smooths a sequence [step][input] in place.
  void apply(float* sequence) noexcept;

 private:
  int steps_ = 0;
  int inputs_ = 0;
  int half_width_ = 0;
  int window_ = 0;            ///< w
  Matrix<double> fit_;        ///< H [e][j]
  std::vector<double> from_;  ///< the sequence before smoothing [row]
};

}  // namespace slalom::detail
