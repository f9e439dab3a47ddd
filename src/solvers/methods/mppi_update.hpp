#pragma once

#include <vector>

#include "solvers/sampling/sample_set.hpp"

namespace slalom::detail {

/// Coefficients [row] of the control term (Honda et al., ICRA 2024, equation (8), where alpha = 0):
///
///     sum_row coefficient v = lambda (1 - alpha) sum_t (u - n)^T Sigma^-1 v
///
/// `temperature` is lambda, `discount` is alpha, `mean` is the samples' mean u and `nominal` is the nominal
/// sequence n. All arrays have `rows` values.
void control_coefficients(double temperature, double discount, double inverse_variance_offset,
                          const float* mean, const float* nominal, const float* variance, int rows,
                          float* coefficients) noexcept;

/// Computes the weights of samples from their costs,
///
/// w = exp(-(J - min J) / lambda).
///
/// lambda is fixed, or adapted so that the effective sample size (sum w)^2 / sum w^2 (Kong 1992) has a wanted
/// value. The search starts at the last solve's lambda. In J = S + lambda g, the control term g is in units
/// of lambda.
class Weighting {
 public:
  /// `temperature` is lambda; 0: adapted. With a `share` above 0 it is adapted, too, to an effective sample
  /// size of that share of the samples, and `temperature` is used where all costs are equal.
  Weighting(double temperature, double share)
      : given_temperature_(temperature), share_(share), temperature_(first()) {}

  /// Whether the temperature is adapted.
  bool seeks() const noexcept { return share_ > 0 || given_temperature_ == 0; }
  /// The temperature of the last weights; 0 before the first ones if it is adapted.
  double temperature() const noexcept { return temperature_; }
  /// Forgets the last solve.
  void reset() noexcept { temperature_ = first(); }

  /// Sets the samples' weights from their totals. `least` is the lowest total. The weights are not
  /// normalised. Returns their sums.
  WeightSums<double> weigh(SampleSet& samples, float least, ThreadPool& pool) noexcept;

  /// Adapts the temperature, then sets the weights as `weigh` does. The samples' stored terms are their
  /// control terms in units of the temperature. If all costs are equal, uses the configured one. The last
  /// `outsiders` samples do not count for the temperature, so that one far better than all others decides.
  WeightSums<double> seek(SampleSet& samples, ThreadPool& pool, int outsiders = 0) noexcept;

 private:
  double first() const noexcept { return seeks() ? 0 : given_temperature_; }

  double given_temperature_, share_, temperature_;
};

/// The closed-form update of MPPI (Williams et al., "Information-Theoretic Model Predictive Control", IEEE
/// T-RO 2018; Honda et al., ICRA 2024, equations (7) and (8)):
///
///     v_k ~ N(u, Sigma),   J_k = S(v_k) + lambda (1 - alpha) sum_t (u - n)^T Sigma^-1 v_k
///     w_k = exp(-(J_k - min J) / lambda) / sum,   u <- sum_k w_k v_k
///
/// u is the last solution, n the nominal sequence, S the cost of a rollout; alpha = 0 in the papers. The
/// noise (NoiseShape) and the weights and lambda (Weighting) can be replaced.
class MppiUpdate {
 public:
  /// Takes the options of `mppi` or `svg_mppi`.
  template <class Options>
  MppiUpdate(const Options& o, int inputs)
      : discount_(o.control_cost_discount),
        inverse_variance_offset_(o.published.inverse_variance_offset),
        normaliser_offset_(o.published.normaliser_offset),
        zero_mean_share_(o.zero_mean_share),
        samples_(o.horizon, inputs, o.samples, NoiseShape(o.noise, o.horizon, inputs)),
        weighting_(o.temperature, o.weighting.target_ess_fraction),
        deviation_(samples_.rows()),
        linear_(deviation_.size()),
        zero_(deviation_.size()),
        sums_(deviation_.size()) {}

  SampleSet& samples() noexcept { return samples_; }
  /// The temperature of the last weights; 0 before the first ones if it is adapted.
  double temperature() const noexcept { return weighting_.temperature(); }
  /// Returns to the configured temperature.
  void reset() noexcept { weighting_.reset(); }

  /// Parameters of the samples, all [row]: the solution u, the nominal sequence n, and the bounds.
  struct Distribution {
    const float *mean, *nominal, *variance, *low, *high;
  };
  /// Draws and evaluates the samples.
  BatchStatistics sample(const BatchEvaluator& evaluator, RandomKey key, const Distribution& from,
                         ThreadPool& pool, const Deadline& deadline) noexcept;
  /// Replaces `mean` [row] (u) by the weighted mean of the samples, which rounding may move beyond the
  /// bounds. The last `outsiders` samples are proposals of other controllers. If no cost is finite, `mean`
  /// does not change. Writes the statistics to `result` and returns the status.
  Status move_mean(const BatchStatistics& drawn, ThreadPool& pool, float* mean, SolveResult& result,
                   int outsiders = 0) noexcept;

 private:
  void set_control_term(double temperature, const Distribution& from) noexcept;

  double discount_;                 ///< alpha
  double inverse_variance_offset_;  ///< added to 1 / variance, 1/input^2
  double normaliser_offset_;        ///< added to the sum of the weights
  double zero_mean_share_;          ///< fraction of the samples that are drawn around zero
  SampleSet samples_;
  Weighting weighting_;
  std::vector<float> deviation_, linear_, zero_;  ///< [row]
  std::vector<double> sums_;                      ///< [row]
};

}  // namespace slalom::detail
