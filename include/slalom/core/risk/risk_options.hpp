#pragma once

#include <cstdint>

#include "slalom/core/options.hpp"

namespace slalom {

/// How the costs of one control sequence in several variants of the world become one cost.
enum class RiskMeasure {
  mean,         ///< the expected cost
  worst,        ///< the largest cost
  cvar,         ///< the conditional value at risk: the mean of the worst share `tail` of the costs
  exponential,  ///< the entropic risk: log(mean(exp(aversion c))) / aversion
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(RiskMeasure) {
  static constexpr const char* const names[] = {"mean", "worst", "cvar", "exponential", nullptr};
  return names;
}

/// Options of rollouts in several variants of the world.
struct RiskOptions {
  int variants = 1;  ///< of the world, in which every sample is rolled out, 1 ... 32; 1: the problem alone
  RiskMeasure measure = RiskMeasure::mean;  ///< what of their costs counts
  double tail = 0.25;                       ///< measure `cvar`: share of the variants that counts
  double aversion = 0.1;                    ///< measure `exponential`, over a unit of cost
  std::uint64_t seed = 0;                   ///< of the variants

  /// Whether all values are equal.
  bool operator==(const RiskOptions&) const = default;
};

/// The most variants of a world.
inline constexpr int max_variants = 32;

/// Declares every option by name, unit, help and range.
template <class Options, class Visit>
requires is_options_of<Options, RiskOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.variants, Declaration{.name = "risk_variants",
                                .symbol = "M",
                                .help = "variants of the world in which every sample is rolled out",
                                .min = 1,
                                .max = max_variants});
  visit(o.measure, Declaration{.name = "risk_measure", .help = "what of a sample's costs in them counts"});
  visit(o.tail, Declaration{.name = "risk_tail",
                            .symbol = "alpha",
                            .help = "risk_measure `cvar`: share of the variants, the worst, that counts",
                            .min = 1e-3,
                            .max = 1});
  visit(o.aversion, Declaration{.name = "risk_aversion",
                                .symbol = "theta",
                                .unit = "1/cost",
                                .help = "risk_measure `exponential`: weight of high costs",
                                .min = 1e-6,
                                .max = 1e6});
  visit(o.seed, Declaration{.name = "risk_seed", .help = "seed of the variants"});
}

}  // namespace slalom
