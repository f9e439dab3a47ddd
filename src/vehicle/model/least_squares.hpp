#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace slalom::vehicle::detail {

/// The limits of drives that identify a car.
struct DriveLimits {
  static constexpr double gap = 0.2;       ///< s between samples of a segment, at most
  static constexpr double settling = 0.5;  ///< s at the beginning of a segment that are not compared: the
                                           ///< angle of the wheels is not known
  static constexpr double delay = 0.3;     ///< s, of commands, at most
  static constexpr int samples = 200;      ///< samples that can be used, at least
  static constexpr int windows = samples / 4;
};

/// A parameter of a least-squares fit.
struct FitParameter {
  double low = 0, high = 0;  ///< its range
  double step = 0;           ///< step of the central differences, > 0
  bool sought = true;        ///< false: keeps its value
};

/// Writes the residuals of these parameters; always as many of them.
using Residuals = std::function<void(std::span<const double> parameters, std::vector<double>& out)>;

/// A minimum of the sum of squared residuals.
struct Fit {
  std::vector<double> values{};  ///< values of the parameters
  Eigen::MatrixXd normal{};      ///< J^T J
  double sum = 0;                ///< sum of squared residuals
};

/// The minimum near `start`, by damped Gauss-Newton steps (Levenberg 1944, Marquardt 1963) with slopes from
/// central differences. The parameters that are sought stay within their ranges, also if `start` is outside;
/// Eigen's Levenberg-Marquardt has no ranges.
Fit least_squares(const Residuals& residuals, std::span<const FitParameter> parameters,
                  std::vector<double> start);

/// The standard deviations of the parameters where residuals have this variance: 0 for one that was not
/// sought, infinite for one that the residuals do not determine.
std::vector<double> deviations(const Fit& fit, std::span<const FitParameter> parameters, double variance);

}  // namespace slalom::vehicle::detail
