#include "solvers/sampling/noise_shape.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "solvers/sampling/rows.hpp"

namespace slalom::detail {

namespace {

/// Longest sequence that can be coloured: its float32 factor takes 8 MiB.
constexpr int longest = 2048;

/// The index of the first entry of row t in a lower triangular matrix.
constexpr std::ptrdiff_t triangle(std::ptrdiff_t t) {
  return t * (t + 1) / 2;
}

/// L of the correlation c(|s - t|), row by row (Cholesky).
std::vector<double> correlation_factor(const std::vector<double>& correlation) {
  const auto steps = static_cast<int>(correlation.size());
  std::vector<double> factor(triangle(steps));
  for (int t = 0; t < steps; ++t) {
    double* row = &factor[triangle(t)];
    for (int s = 0; s <= t; ++s) {
      const double* other = &factor[triangle(s)];
      double rest = correlation[t - s];
      for (int i = 0; i < s; ++i) rest -= row[i] * other[i];
      // With a steep spectrum, noise is nearly a polynomial, and the remainder may be below rounding error.
      row[s] = s < t ? rest / other[s] : std::sqrt(std::max(rest, 1e-14));
    }
  }
  return factor;
}

}  // namespace

std::vector<double> coloured_correlation(double exponent, int steps) {
  const int period = 2 * steps;
  std::vector<double> power(period), cosine(period);
  for (int k = 0; k < period; ++k) {
    const int frequency = std::max(std::min(k, period - k), 1);
    power[k] = std::pow(frequency, -exponent);
    cosine[k] = std::cos(2 * 3.14159265358979323846 * k / period);
  }
  std::vector<double> correlation(steps);
  for (std::size_t d = 0; d < correlation.size(); ++d) {
    for (std::size_t k = 0; k < power.size(); ++k) correlation[d] += power[k] * cosine[k * d % power.size()];
  }
  const double variance = correlation[0];
  for (double& c : correlation) c /= variance;
  return correlation;
}

NoiseShape::NoiseShape(const PerInput& exponent, const PerInput& log_normal_spread, int steps, int inputs,
                       int samples)
    : steps_(steps), inputs_(inputs) {
  factor_.resize(inputs);
  factor_float_.resize(factor_.size());
  bool spread = false;
  for (int i = 0; i < inputs; ++i) {
    spread = spread || log_normal_spread[i] > 0;
    if (!(exponent[i] > 0)) continue;
    if (steps > longest) {
      throw std::invalid_argument("noise_exponent: must be 0 for a horizon above " + std::to_string(longest) +
                                  " steps; the horizon is " + std::to_string(steps));
    }
    factor_[i] = correlation_factor(coloured_correlation(exponent[i], steps));
    factor_float_[i].assign(factor_[i].begin(), factor_[i].end());
    coloured_ = true;
  }
  if (!spread) return;
  for (int r = 0; r < steps * inputs; ++r)
    spread_.push_back(static_cast<float>(log_normal_spread[r % inputs]));
  exponents_ = SequenceBatch(steps, inputs, samples);
}

void NoiseShape::apply(SequenceBatch& z, Range range, RandomKey key) noexcept {
  const Rows<float> rows = rows_of(z);
  if (coloured_) {
    for (int i = 0; i < inputs_; ++i) {
      const std::vector<float>& factor = factor_float_[i];
      if (!factor.empty()) kernels().colour(rows, factor.data(), i, inputs_, range);
    }
  }
  if (!spread_.empty()) {
    // The complement of the seed gives an independent stream.
    fill_normal(exponents_, range.first, range.count, {~key.seed, key.stream});
    kernels().spread_log_normal(rows, exponents_.data(), spread_.data(), range);
  }
}

void NoiseShape::whiten_twice(double* sequence) const noexcept {
  for (int i = 0; i < inputs_; ++i) {
    const std::vector<double>& factor = factor_[i];
    if (factor.empty()) continue;
    const auto entry = [&](int t) -> double& { return sequence[t * inputs_ + i]; };
    for (int t = 0; t < steps_; ++t) {
      const double* row = &factor[triangle(t)];
      double rest = entry(t);
      for (int s = 0; s < t; ++s) rest -= row[s] * entry(s);
      entry(t) = rest / row[t];
    }
    for (int t = steps_ - 1; t >= 0; --t) {
      const double* row = &factor[triangle(t)];
      entry(t) /= row[t];
      for (int s = 0; s < t; ++s) entry(s) -= row[s] * entry(t);
    }
  }
}

}  // namespace slalom::detail
