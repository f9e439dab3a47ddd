#pragma once

#include <vector>

namespace slalom::detail {

/// Smooths a control sequence (Savitzky and Golay 1964; in MPPI: Williams et al. 2018): every entry becomes
/// the value there of the polynomial that fits the entries round it best. At the ends, where the window
/// cannot be centred, the first or last whole window serves. What is a polynomial of the degree already stays
/// as it is.
///
/// With p_0 ... p_d orthonormal polynomials over a window of w entries, entry e of the fit is
/// sum_j H[e][j] u[j], H[e][j] = sum_i p_i(e) p_i(j).
class Smoother {
 public:
  /// Leaves sequences as they are.
  Smoother() = default;
  /// A window of 2 half_width + 1 entries, or as many as there are, and a polynomial of at most `degree`.
  Smoother(int steps, int inputs, int half_width, int degree);

  bool active() const noexcept { return window_ > 1; }

  /// Smooths a sequence [step][input] in place.
  void apply(float* sequence) noexcept;

 private:
  int steps_ = 0;
  int inputs_ = 0;
  int half_width_ = 0;
  int window_ = 0;            ///< w
  std::vector<double> fit_;   ///< H [e][j]
  std::vector<double> from_;  ///< the sequence as it was [row]
};

}  // namespace slalom::detail
