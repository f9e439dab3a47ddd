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

constexpr int iterations = 60;

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

class Fitter {
 public:
  Fitter(const Residuals& residuals, std::span<const FitParameter> parameters)
      : residuals_of_(residuals), parameters_(parameters) {}

  Fit fit(std::vector<double> start) {
    limit(start);
    Fit best{std::move(start), {}, 0};
    residuals_ = residuals_at(best.values);
    best.sum = residuals_.squaredNorm();
    double damping = 1e-3;
    for (int iteration = 0; iteration < iterations; ++iteration) {
      const VectorXd slope = linearise(best);
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
  VectorXd residuals_at(const std::vector<double>& values) {
    residuals_of_(values, buffer_);
    return VectorXd::Map(buffer_.data(), static_cast<Eigen::Index>(buffer_.size()));
  }

  /// Clamps the parameters that are sought to their ranges.
  void limit(std::vector<double>& values) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      if (parameters_[i].sought) values[i] = std::clamp(values[i], parameters_[i].low, parameters_[i].high);
  }

  /// Moves `best` where a damped step lowers the sum.
  bool step(Fit& best, const VectorXd& slope, double damping) {
    MatrixXd damped = best.normal;
    damped.diagonal() *= 1 + damping;
    const auto move = solve(damped, slope, parameters_);
    if (!move) return false;
    std::vector<double> tried = best.values;
    for (std::size_t i = 0; i < tried.size(); ++i) tried[i] -= (*move)[static_cast<Eigen::Index>(i)];
    limit(tried);
    VectorXd residuals = residuals_at(tried);
    const double sum = residuals.squaredNorm();
    if (!(sum < best.sum)) return false;
    best.values = std::move(tried);
    best.sum = sum;
    residuals_ = std::move(residuals);
    return true;
  }

  /// Sets `fit.normal` and returns J^T r; J by central differences.
  VectorXd linearise(Fit& fit) {
    MatrixXd jacobian = MatrixXd::Zero(residuals_.size(), static_cast<Eigen::Index>(parameters_.size()));
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (!parameters_[i].sought) continue;
      std::vector<double> low = fit.values, high = fit.values;
      low[i] -= parameters_[i].step;
      high[i] += parameters_[i].step;
      jacobian.col(static_cast<Eigen::Index>(i)) =
          (residuals_at(high) - residuals_at(low)) / (2 * parameters_[i].step);
    }
    fit.normal = jacobian.transpose() * jacobian;
    return jacobian.transpose() * residuals_;
  }

  const Residuals& residuals_of_;
  std::span<const FitParameter> parameters_;
  VectorXd residuals_;
  std::vector<double> buffer_;
};

}  // namespace

Fit least_squares(const Residuals& residuals, std::span<const FitParameter> parameters,
                  std::vector<double> start) {
  return Fitter(residuals, parameters).fit(std::move(start));
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
