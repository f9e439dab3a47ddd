#include "solvers/sampling/smoother.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::detail {

namespace {

/// The orthonormal polynomials p_0 ... p_degree at the entries 0 ... window - 1, [polynomial][entry].
Matrix<double> orthonormal_polynomials(int window, int degree) {
  Matrix<double> basis(degree + 1, window);
  const double middle = 0.5 * (window - 1), scale = window > 1 ? 1 / middle : 1;
  for (int i = 0; i <= degree; ++i) {
    double* p = basis[i];
    for (int j = 0; j < window; ++j) {
      // x times the previous polynomial: it spans the same space as x^i, and is almost orthogonal already.
      p[j] = i > 0 ? (j - middle) * scale * basis[i - 1][j] : 1.0;
    }
    for (int pass = 0; pass < 2; ++pass) {  // the second pass removes the rounding errors of the first
      for (int b = 0; b < i; ++b) {
        double along = 0;
        for (int j = 0; j < window; ++j) along += basis[b][j] * p[j];
        for (int j = 0; j < window; ++j) p[j] -= along * basis[b][j];
      }
    }
    double squared = 0;
    for (int j = 0; j < window; ++j) squared += p[j] * p[j];
    for (int j = 0; j < window; ++j) p[j] /= std::sqrt(squared);
  }
  return basis;
}

}  // namespace

Smoother::Smoother(int steps, int inputs, int half_width, int degree)
    : steps_(steps), inputs_(inputs), half_width_(half_width), window_(std::min(2 * half_width + 1, steps)) {
  const int highest = std::min(degree, window_ - 1);
  const Matrix<double> basis = orthonormal_polynomials(window_, highest);
  fit_ = Matrix<double>(window_, window_);
  for (int e = 0; e < window_; ++e)
    for (int j = 0; j < window_; ++j)
      for (int i = 0; i <= highest; ++i) fit_[e][j] += basis[i][e] * basis[i][j];
  from_.resize(steps * inputs);
}

void Smoother::apply(float* sequence) noexcept {
  std::copy_n(sequence, from_.size(), from_.begin());
  for (int k = 0; k < steps_; ++k) {
    const int first = std::clamp(k - half_width_, 0, steps_ - window_);
    const double* row = fit_[k - first];
    for (int i = 0; i < inputs_; ++i) {
      double sum = 0;
      for (int j = 0; j < window_; ++j) sum += row[j] * from_[(first + j) * inputs_ + i];
      sequence[k * inputs_ + i] = static_cast<float>(sum);
    }
  }
}

}  // namespace slalom::detail
