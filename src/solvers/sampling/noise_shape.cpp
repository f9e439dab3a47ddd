#include "solvers/sampling/noise_shape.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace slalom::detail {

namespace {

/// Longest sequence that can be correlated: its float32 factor takes 8 MiB.
constexpr int longest = 2048;

/// Largest number of knots, as declared in option_groups.hpp.
constexpr int max_knots = 64;

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

/// L of a matrix [rows][columns] = L Q with orthonormal rows of Q (Gram-Schmidt, each step twice), lower
/// triangular, row by row. Where a row is a combination of those before, it adds no row to Q.
std::vector<double> orthogonal_factor(const std::vector<double>& matrix, int rows, int columns) {
  std::vector<double> factor(triangle(rows));
  std::vector<std::vector<double>> basis;
  for (int t = 0; t < rows; ++t) {
    std::vector<double> rest(matrix.begin() + t * columns, matrix.begin() + (t + 1) * columns);
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t b = 0; b < basis.size(); ++b) {
        const double part = std::inner_product(rest.begin(), rest.end(), basis[b].begin(), 0.0);
        factor[triangle(t) + b] += part;
        for (int k = 0; k < columns; ++k) rest[k] -= part * basis[b][k];
      }
    }
    const double length = std::sqrt(std::inner_product(rest.begin(), rest.end(), rest.begin(), 0.0));
    if (static_cast<int>(basis.size()) == columns || length < 1e-10) continue;
    factor[triangle(t) + static_cast<std::ptrdiff_t>(basis.size())] = length;
    for (double& value : rest) value /= length;
    basis.push_back(std::move(rest));
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

std::vector<double> knot_weights(int steps, int knots) {
  const double distance = knots > 1 ? (steps - 1.0) / (knots - 1) : 1;
  const auto kernel = [](double a, double b) { return std::exp(-0.5 * (a - b) * (a - b)); };
  Eigen::MatrixXd between(knots, knots), to_steps(knots, steps);
  for (int k = 0; k < knots; ++k) {
    for (int j = 0; j < knots; ++j) between(k, j) = kernel(k, j);
    for (int t = 0; t < steps; ++t) to_steps(k, t) = knots > 1 ? kernel(t / distance, k) : 1;
  }
  Eigen::MatrixXd weights = between.llt().solve(to_steps);
  weights.colwise().normalize();
  return {weights.data(), weights.data() + weights.size()};
}

NoiseShape::NoiseShape(const NoiseOptions& options, int steps, int inputs)
    : steps_(steps), inputs_(inputs), factor_(inputs), factor_float_(inputs) {
  colour(options);
  if (options.knots > 0) interpolate(std::min(options.knots, steps));
  for (std::size_t i = 0; i < factor_.size(); ++i)
    factor_float_[i].assign(factor_[i].begin(), factor_[i].end());
}

/// Throws std::invalid_argument if a sequence is too long for the factor of an option.
void NoiseShape::check_length(const char* option) const {
  if (steps_ <= longest) return;
  throw std::invalid_argument(std::string(option) + ": must be 0 for a horizon above " +
                              std::to_string(longest) + " steps; the horizon is " + std::to_string(steps_));
}

void NoiseShape::colour(const NoiseOptions& options) {
  for (int i = 0; i < inputs_; ++i) {
    if (!(options.exponent[i] > 0)) continue;
    check_length("noise_exponent");
    const int before = options.pinned ? 1 : 0;
    const std::vector<double> factor =
        correlation_factor(coloured_correlation(options.exponent[i], steps_ + before));
    for (int t = before; t < steps_ + before; ++t)
      factor_[i].insert(factor_[i].end(), &factor[triangle(t)] + before, &factor[triangle(t)] + t + 1);
    correlated_ = true;
    pinned_ = options.pinned;
  }
}

void NoiseShape::interpolate(int knots) {
  if (correlated_) throw std::invalid_argument("noise_knots: must be 0 where noise_exponent is above 0");
  check_length("noise_knots");
  correlated_ = true;
  knots_ = knots;
  const std::vector<double> weights = knot_weights(steps_, knots);
  std::fill(factor_.begin(), factor_.end(), orthogonal_factor(weights, steps_, knots));
  const Eigen::Map<const Eigen::MatrixXd> transposed(weights.data(), knots, steps_);
  const Eigen::MatrixXd projection = (transposed * transposed.transpose()).llt().solve(transposed);
  projection_.assign(projection.data(), projection.data() + projection.size());
}

void NoiseShape::apply(SequenceBatch& z, Range range) const noexcept {
  const Rows rows = rows_of(z);
  for (int i = 0; i < inputs_; ++i) {
    const std::vector<float>& factor = factor_float_[i];
    if (!factor.empty()) kernels::colour(rows, factor.data(), i, inputs_, range);
  }
}

/// Multiplies the entries of an input by W (W^T W)^-2 W^T, the pseudo-inverse of W W^T.
void NoiseShape::project_twice(double* sequence, int input) const noexcept {
  double at_knots[max_knots] = {};
  for (int t = 0; t < steps_; ++t)
    for (int k = 0; k < knots_; ++k)
      at_knots[k] += projection_[t * knots_ + k] * sequence[t * inputs_ + input];
  for (int t = 0; t < steps_; ++t) {
    double sum = 0;
    for (int k = 0; k < knots_; ++k) sum += projection_[t * knots_ + k] * at_knots[k];
    sequence[t * inputs_ + input] = sum;
  }
}

void NoiseShape::whiten_twice(double* sequence) const noexcept {
  for (int i = 0; i < inputs_; ++i) {
    const std::vector<double>& factor = factor_[i];
    if (factor.empty()) continue;
    if (knots_ > 0) {
      project_twice(sequence, i);
      continue;
    }
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
