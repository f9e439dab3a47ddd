#pragma once

#include "slalom/core/options.hpp"

namespace slalom {

/// Ways to make one cost of the costs of a sequence in several variants of the world.
enum class RiskMeasure {
  mean,         ///< the expected cost
  worst,        ///< the largest cost
  cvar,         ///< the conditional value at risk: the mean of the worst share `tail` of the costs
  exponential,  ///< the entropic risk: log(mean(exp(aversion c))) / aversion
};
inline const char* const* enum_names(RiskMeasure) {
  static constexpr const char* const names[] = {"mean", "worst", "cvar", "exponential", nullptr};
  return names;
}

/// Options of rollouts in several variants of the world. `visit_options` below describes the fields.
struct RiskOptions {
  int variants = 1;
  RiskMeasure measure = RiskMeasure::mean;
  double tail = 0.25;
  double aversion = 0.1;
  std::uint64_t seed = 0;

  bool operator==(const RiskOptions&) const = default;
};

/// The most variants of a world.
inline constexpr int max_variants = 32;

template <class Options, class Visit>
requires is_options_of<Options, RiskOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.variants, {"risk_variants", "",
                     "variants of the world in which every sample is rolled out; 1: the problem alone", 1,
                     max_variants, "M"});
  visit(o.measure, {"risk_measure", "", "how the costs of a sample in the variants become one cost"});
  visit(o.tail,
        {"risk_tail", "", "risk_measure `cvar`: share of the variants, those of highest cost, that counts",
         1e-3, 1, "alpha"});
  visit(o.aversion,
        {"risk_aversion", "1/cost", "risk_measure `exponential`: weight of high costs", 1e-6, 1e6, "theta"});
  visit(o.seed, {"risk_seed", "", "seed of the variants"});
}

/// The costs of a range of samples in every variant of the world, [variant][sample].
struct VariantCosts {
  static constexpr int capacity = 128;               ///< samples
  alignas(64) float values[max_variants][capacity];  ///< the costs
};

/// Writes the risk of the first `count` samples: `options.measure` of their costs in the first
/// `options.variants` variants. A cost that is not a number counts as infinite. The order of the costs may
/// change. `to` holds `count` values.
///
///  - cvar: the mean of the worst alpha M of M costs, of which the last may count in part (Rockafellar &
///    Uryasev, "Optimization of Conditional Value-at-Risk", 2000, for M equally likely outcomes);
///  - exponential: log(sum_m exp(theta c_m) / M) / theta (Whittle, "Risk-sensitive linear/quadratic/Gaussian
///    control", 1981).
void measure_risk(VariantCosts& costs, int count, const RiskOptions& options, float* to) noexcept;

}  // namespace slalom
