#include "solvers/sampling/spline.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "slalom/solvers/solver_base.hpp"

namespace slalom::detail {

namespace {

/// The `degree` + 1 weights at `x` in interval `interval` of a clamped uniform B-spline with `intervals`
/// intervals of length 1 (Piegl and Tiller, algorithm A2.2).
void basis(double x, int interval, int intervals, int degree, double* weights) {
  const auto knot = [&](int i) -> double { return std::clamp(i - degree, 0, intervals); };
  const int i = interval + degree;
  weights[0] = 1;
  for (int d = 1; d <= degree; ++d) {
    double saved = 0;
    for (int r = 0; r < d; ++r) {
      const double right = knot(i + r + 1) - x, left = x - knot(i + 1 - d + r);
      const double part = weights[r] / (right + left);
      weights[r] = saved + right * part;
      saved = left * part;
    }
    weights[d] = saved;
  }
}

}  // namespace

Spline::Spline(int steps, int points, int inputs)
    : steps_(steps),
      points_(std::min(points, steps)),
      inputs_(inputs),
      count_(std::min(points_, most_)),
      first_(steps),
      weights_(steps * count_),
      fit_(points_ * steps),
      sequence_(steps * inputs),
      moved_(sequence_.size()) {
  const int intervals = points_ - count_ + 1;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(points_, steps);  // W' [point][step]
  for (int t = 0; t < steps; ++t) {
    const double x = steps > 1 ? intervals * (t / (steps - 1.0)) : 0;
    first_[t] = std::min(static_cast<int>(x), intervals - 1);
    double weights[most_];
    basis(x, first_[t], intervals, count_ - 1, weights);
    for (int k = 0; k < count_; ++k) {
      weights_[t * count_ + k] = static_cast<float>(weights[k]);
      all(first_[t] + k, t) = weights[k];
    }
  }
  const Eigen::MatrixXd fit = (all * all.transpose()).llt().solve(all);  // (W' W)^-1 W'
  for (int p = 0; p < points_; ++p)
    for (int t = 0; t < steps; ++t) fit_[p * steps + t] = static_cast<float>(fit(p, t));
}

void Spline::expand(const float* points, float* sequence) const noexcept {
  for (int t = 0; t < steps_; ++t) {
    for (int i = 0; i < inputs_; ++i) {
      float sum = 0;
      for (int k = 0; k < count_; ++k)
        sum += weights_[t * count_ + k] * points[(first_[t] + k) * inputs_ + i];
      sequence[t * inputs_ + i] = sum;
    }
  }
}

void Spline::expand_variances(const float* points, float* sequence) const noexcept {
  for (int t = 0; t < steps_; ++t) {
    for (int i = 0; i < inputs_; ++i) {
      float sum = 0;
      for (int k = 0; k < count_; ++k) {
        const float weight = weights_[t * count_ + k];
        sum += weight * weight * points[(first_[t] + k) * inputs_ + i];
      }
      sequence[t * inputs_ + i] = sum;
    }
  }
}

void Spline::expand(const SequenceBatch& points, SequenceBatch& sequences, Range range) const noexcept {
  for (int t = 0; t < steps_; ++t) {
    for (int i = 0; i < inputs_; ++i) {
      float* const to = sequences.row(t, i) + range.first;
      for (int k = 0; k < count_; ++k) {
        const float* const from = points.row(first_[t] + k, i) + range.first;
        const float weight = weights_[t * count_ + k];
        for (int s = 0; s < range.count; ++s) to[s] = (k > 0 ? to[s] : 0.0f) + weight * from[s];
      }
    }
  }
}

void Spline::shift(float* points, double shift) noexcept {
  expand(points, sequence_.data());
  shift_sequence(sequence_.data(), steps_, inputs_, shift, moved_.data());
  for (int p = 0; p < points_; ++p) {
    for (int i = 0; i < inputs_; ++i) {
      float sum = 0;
      for (int t = 0; t < steps_; ++t) sum += fit_[p * steps_ + t] * moved_[t * inputs_ + i];
      points[p * inputs_ + i] = sum;
    }
  }
}

}  // namespace slalom::detail
