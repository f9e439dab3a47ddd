#pragma once

#include "solvers/sampling/sample_set.hpp"

namespace slalom::detail {

/// How the costs of samples become weights.
///
/// w = e_q(-(J - min J) / lambda) with the q-exponential e_q(x) = [1 + (1 - q) x]_+^(1 / (1 - q)) (Wang et
/// al., "Variational Inference MPC using Tsallis Divergence", RSS 2021, where r is 2 - q). q = 1 is exp. For
/// q < 1 costs above the least by lambda / (1 - q) or more have weight 0, as in the cross-entropy method; for
/// q > 1 the weights fall by a power alone.
///
/// lambda is given, or sought so that the effective sample size (sum w)^2 / sum w^2 (Kong 1992) is a share of
/// the samples. It grows with lambda from 1 to their number, so a bracket and false position on log lambda
/// find it; the search starts from the last solve's. J = S + lambda g has the control term g in units of
/// lambda.
class Weighting {
 public:
  struct Settings {
    double temperature = 1;  ///< lambda
    double index = 1;        ///< q
    double share = 0;        ///< of the samples, effective; 0: lambda as given
  };

  Weighting() = default;
  explicit Weighting(const Settings& settings) : settings_(settings), temperature_(settings.temperature) {}

  /// Whether the temperature is sought.
  bool seeks() const noexcept { return settings_.share > 0; }
  /// The temperature of the last weights.
  double temperature() const noexcept { return temperature_; }
  void reset() noexcept { temperature_ = settings_.temperature; }

  /// Weighs samples by their totals, the least of which is `least`. Returns the sums of the weights, which
  /// are not normalised.
  WeightSums<double> weigh(SampleSet& samples, float least, ThreadPool& pool) noexcept;

  /// Seeks the temperature first: the samples' terms are their control terms in units of it. Where none gives
  /// the effective sample size, the one that was set holds.
  WeightSums<double> seek(SampleSet& samples, ThreadPool& pool) noexcept;

 private:
  WeightSums<double> try_temperature(SampleSet& samples, double logarithm, ThreadPool& pool) noexcept;

  Settings settings_;
  double temperature_ = 1;
};

}  // namespace slalom::detail
