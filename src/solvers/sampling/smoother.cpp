#include "solvers/sampling/smoother.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::detail {

namespace {

/// p_0 ... p_degree over the places 0 ... window - 1, one after another.
std::vector<double> orthonormal_polynomials(int window, int degree) {
  const auto w = static_cast<std::size_t>(window);
  std::vector<double> basis;
  for (int i = 0; i <= degree; ++i) {
    std::vector<double> p(w, 1.0);
    const double middle = 0.5 * (window - 1), scale = window > 1 ? 1 / middle : 1;
    for (std::size_t j = 0; j < w && i > 0; ++j) {
      // x times the polynomial before: as good as x^i, and nearly orthogonal to the others already.
      p[j] = (static_cast<double>(j) - middle) * scale * basis[static_cast<std::size_t>(i - 1) * w + j];
    }
    for (int twice = 0; twice < 2; ++twice) {
      for (std::size_t b = 0; b < static_cast<std::size_t>(i); ++b) {
        double along = 0;
        for (std::size_t j = 0; j < w; ++j) along += basis[b * w + j] * p[j];
        for (std::size_t j = 0; j < w; ++j) p[j] -= along * basis[b * w + j];
      }
    }
    double squared = 0;
    for (const double value : p) squared += value * value;
    for (double& value : p) value /= std::sqrt(squared);
    basis.insert(basis.end(), p.begin(), p.end());
  }
  return basis;
}

}  // namespace

Smoother::Smoother(int steps, int inputs, int half_width, int degree)
    : steps_(steps), inputs_(inputs), half_width_(half_width), window_(std::min(2 * half_width + 1, steps)) {
  const auto w = static_cast<std::size_t>(window_);
  const std::vector<double> basis = orthonormal_polynomials(window_, std::min(degree, window_ - 1));
  fit_.resize(w * w);
  for (std::size_t e = 0; e < w; ++e)
    for (std::size_t j = 0; j < w; ++j)
      for (std::size_t i = 0; i < basis.size() / w; ++i)
        fit_[e * w + j] += basis[i * w + e] * basis[i * w + j];
  from_.resize(static_cast<std::size_t>(steps * inputs));
}

void Smoother::apply(float* sequence) noexcept {
  std::copy_n(sequence, from_.size(), from_.begin());
  for (int k = 0; k < steps_; ++k) {
    const int first = std::clamp(k - half_width_, 0, steps_ - window_);
    const double* row = &fit_[static_cast<std::size_t>(k - first) * static_cast<std::size_t>(window_)];
    for (int i = 0; i < inputs_; ++i) {
      double sum = 0;
      for (int j = 0; j < window_; ++j)
        sum += row[j] * from_[static_cast<std::size_t>((first + j) * inputs_ + i)];
      sequence[k * inputs_ + i] = static_cast<float>(sum);
    }
  }
}

}  // namespace slalom::detail
