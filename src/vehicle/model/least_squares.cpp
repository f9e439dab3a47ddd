#include "vehicle/model/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace slalom::vehicle::detail {
namespace {

constexpr int iterations = 60;

double square_sum(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return sum;
}

/// Solves a x = b for the parameters that are sought and that the residuals depend on, the others being 0;
/// empty if a is singular without them.
std::optional<std::vector<double>> solve(std::vector<double> a, std::vector<double> b,
                                         std::span<const FitParameter> parameters) {
  const std::size_t n = b.size();
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return a[i * n + j]; };
  for (std::size_t i = 0; i < n; ++i) {
    if (parameters[i].sought && at(i, i) > 0) continue;
    for (std::size_t j = 0; j < n; ++j) at(i, j) = at(j, i) = i == j;
    b[i] = 0;
  }
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(at(i, k)) > std::abs(at(pivot, k))) pivot = i;
    if (!(std::abs(at(pivot, k)) > 1e-300)) return std::nullopt;
    for (std::size_t j = 0; j < n; ++j) std::swap(at(k, j), at(pivot, j));
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = at(i, k) / at(k, k);
      for (std::size_t j = k; j < n; ++j) at(i, j) -= factor * at(k, j);
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= at(k, j) * b[j];
    b[k] /= at(k, k);
  }
  return b;
}

class Fitter {
 public:
  Fitter(const Residuals& residuals, std::span<const FitParameter> parameters)
      : of_(residuals), parameters_(parameters) {}

  Fit fit(std::vector<double> start) {
    Fit best;
    best.values = std::move(start);
    limit(best.values);
    of_(best.values, residuals_);
    best.sum = square_sum(residuals_);
    double damping = 1e-3;
    for (int iteration = 0; iteration < iterations; ++iteration) {
      const std::vector<double> slope = linearise(best);
      bool better = false;
      double gained = 0;
      while (!better && damping < 1e12) {
        const double before = best.sum;
        better = step(best, slope, damping);
        gained = before - best.sum;
        damping *= better ? 0.2 : 8;
      }
      if (!better || gained < 1e-10 * best.sum) break;
    }
    linearise(best);
    return best;
  }

 private:
  /// Clamps the parameters that are sought to their ranges.
  void limit(std::vector<double>& values) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      if (parameters_[i].sought) values[i] = std::clamp(values[i], parameters_[i].low, parameters_[i].high);
  }

  /// Moves `best` where a damped step lowers the sum.
  bool step(Fit& best, const std::vector<double>& slope, double damping) {
    const std::size_t n = parameters_.size();
    std::vector<double> damped = best.normal;
    for (std::size_t i = 0; i < n; ++i) damped[i * n + i] *= 1 + damping;
    const auto move = solve(std::move(damped), slope, parameters_);
    if (!move) return false;
    std::vector<double> tried = best.values;
    for (std::size_t i = 0; i < n; ++i) tried[i] -= (*move)[i];
    limit(tried);
    of_(tried, trial_);
    const double sum = square_sum(trial_);
    if (!(sum < best.sum)) return false;
    best.values = std::move(tried);
    best.sum = sum;
    residuals_ = trial_;
    return true;
  }

  /// Sets `fit.normal` and returns J^T r.
  std::vector<double> linearise(Fit& fit) {
    const std::size_t n = parameters_.size();
    std::vector<std::vector<double>> columns(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (!parameters_[i].sought) continue;
      std::vector<double> low = fit.values, high = fit.values;
      low[i] -= parameters_[i].step;
      high[i] += parameters_[i].step;
      of_(high, columns[i]);
      of_(low, trial_);
      for (std::size_t k = 0; k < trial_.size(); ++k)
        columns[i][k] = (columns[i][k] - trial_[k]) / (2 * parameters_[i].step);
    }
    std::vector<double> slope(n);
    fit.normal.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < columns[i].size(); ++k) slope[i] += columns[i][k] * residuals_[k];
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k < columns[i].size() && k < columns[j].size(); ++k)
          fit.normal[i * n + j] += columns[i][k] * columns[j][k];
    }
    return slope;
  }

  const Residuals& of_;
  std::span<const FitParameter> parameters_;
  std::vector<double> residuals_, trial_;
};

}  // namespace

Fit least_squares(const Residuals& residuals, std::span<const FitParameter> parameters,
                  std::vector<double> start) {
  return Fitter(residuals, parameters).fit(std::move(start));
}

std::vector<double> deviations(const Fit& fit, std::span<const FitParameter> parameters, double variance) {
  const std::size_t n = parameters.size();
  std::vector<double> found(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!parameters[i].sought) continue;
    std::vector<double> unit(n);
    unit[i] = 1;
    const bool determined = fit.normal[i * n + i] > 0;
    const auto column = determined ? solve(fit.normal, unit, parameters) : std::nullopt;
    found[i] = column ? std::sqrt(std::max(0.0, variance * (*column)[i])) : INFINITY;
  }
  return found;
}

}  // namespace slalom::vehicle::detail
