#include "vehicle/model/least_squares.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace slalom::vehicle::detail {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int iterations = 60;  // steps of a fit, at most

/// Solves a x = b, a symmetric, for the parameters that are sought and that the residuals depend on, the
/// others being 0; empty if a is not positive definite without them.
std::optional<VectorXd> solve(const MatrixXd& a, const VectorXd& b,
                              std::span<const FitParameter> parameters) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < b.size(); ++i)
    if (parameters[i].sought && a(i, i) > 0) free.push_back(i);
  VectorXd x = VectorXd::Zero(b.size());
  if (free.empty()) return x;
  const Eigen::LDLT<MatrixXd> factors(a(free, free));
  if (!(factors.vectorD().minCoeff() > 0)) return std::nullopt;
  const VectorXd found = factors.solve(VectorXd(b(free)));
  x(free) = found;
  return x;
}

}  // namespace

Fit least_squares(const Residuals& residuals_of, std::span<const FitParameter> parameters,
                  std::vector<double> start) {
  std::vector<double> buffer;
  const auto residuals_at = [&](const std::vector<double>& values) -> VectorXd {
    residuals_of(values, buffer);
    return VectorXd::Map(buffer.data(), static_cast<Eigen::Index>(buffer.size()));
  };
  const auto limit = [&](std::vector<double>& values) {
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (parameters[i].sought) values[i] = std::clamp(values[i], parameters[i].low, parameters[i].high);
  };
  limit(start);
  Fit best{std::move(start), {}, 0};
  VectorXd residuals = residuals_at(best.values);
  best.sum = residuals.squaredNorm();

  // Sets `best.normal` and returns J^T r; J by central differences.
  const auto linearise = [&]() -> VectorXd {
    MatrixXd jacobian = MatrixXd::Zero(residuals.size(), static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const double step = parameters[i].step;
      if (!parameters[i].sought) continue;
      std::vector<double> low = best.values, high = best.values;
      low[i] -= step;
      high[i] += step;
      jacobian.col(static_cast<Eigen::Index>(i)) = (residuals_at(high) - residuals_at(low)) / (2 * step);
    }
    best.normal = jacobian.transpose() * jacobian;
    return jacobian.transpose() * residuals;
  };
  // Moves `best` where a damped step lowers the sum.
  const auto step = [&](const VectorXd& slope, double damping) {
    MatrixXd damped = best.normal;
    damped.diagonal() *= 1 + damping;
    const auto move = solve(damped, slope, parameters);
    if (!move) return false;
    std::vector<double> tried = best.values;
    for (std::size_t i = 0; i < tried.size(); ++i) tried[i] -= (*move)[static_cast<Eigen::Index>(i)];
    limit(tried);
    VectorXd there = residuals_at(tried);
    const double sum = there.squaredNorm();
    if (!(sum < best.sum)) return false;
    best.values = std::move(tried);
    best.sum = sum;
    residuals = std::move(there);
    return true;
  };

  double damping = 1e-3;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const VectorXd slope = linearise();
    bool better = false;
    const double before = best.sum;
    for (; !better && damping < 1e12; damping *= better ? 0.2 : 8) better = step(slope, damping);
    if (!better || before - best.sum < 1e-10 * best.sum) break;
  }
  linearise();
  return best;
}

std::vector<double> deviations(const Fit& fit, std::span<const FitParameter> parameters, double variance) {
  const auto n = static_cast<Eigen::Index>(parameters.size());
  std::vector<double> found;
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool sought = parameters[i].sought;
    const auto column =
        fit.normal(i, i) > 0 ? solve(fit.normal, VectorXd::Unit(n, i), parameters) : std::nullopt;
    found.push_back(!sought ? 0 : column ? std::sqrt(std::max(0.0, variance * (*column)[i])) : INFINITY);
  }
  return found;
}

}  // namespace slalom::vehicle::detail
