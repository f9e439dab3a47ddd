#pragma once

#include "solvers/sampling/sample_set.hpp"

namespace slalom::detail {

/// Computes the weights of samples from their costs.
///
/// w = e_q(-(J - min J) / lambda) with the q-exponential e_q(x) = [1 + (1 - q) x]_+^(1 / (1 - q)) (Wang et
/// al., "Variational Inference MPC using Tsallis Divergence", RSS 2021, where r is 2 - q). q = 1 is exp. For
/// q < 1, samples whose cost is lambda / (1 - q) or more above the lowest have weight 0, as in the
/// cross-entropy method. For q > 1, the weights decrease as a power of the cost.
///
/// lambda is fixed, or adapted so that the effective sample size (sum w)^2 / sum w^2 (Kong 1992) is a
/// fraction of the number of samples. The effective sample size grows with lambda from 1 to the number of
/// samples, so lambda is found by bracketing and false position on log lambda, starting from the last solve's
/// value. In J = S + lambda g, the control term g is in units of lambda.
class Weighting {
 public:
  struct Settings {
    double temperature = 1;  ///< lambda
    double index = 1;        ///< q
    double share = 0;        ///< effective sample size / samples; 0: lambda is fixed
  };

  Weighting() = default;
  explicit Weighting(const Settings& settings) : settings_(settings), temperature_(settings.temperature) {}

  /// Whether the temperature is adapted.
  bool seeks() const noexcept { return settings_.share > 0; }
  /// The temperature of the last weights.
  double temperature() const noexcept { return temperature_; }
  /// Returns to the configured temperature.
  void reset() noexcept { temperature_ = settings_.temperature; }

  /// Sets the samples' weights from their totals, of which `least` is the lowest. The weights are not
  /// normalised. Returns their sums.
  WeightSums<double> weigh(SampleSet& samples, float least, ThreadPool& pool) noexcept;

  /// Adapts the temperature, then sets the weights as `weigh` does. The samples' stored terms are their
  /// control terms in units of the temperature. If no temperature gives the effective sample size, the
  /// configured one is used.
  WeightSums<double> seek(SampleSet& samples, ThreadPool& pool) noexcept;

 private:
  WeightSums<double> try_temperature(SampleSet& samples, double logarithm, ThreadPool& pool) noexcept;

  Settings settings_;
  double temperature_ = 1;
};

}  // namespace slalom::detail
