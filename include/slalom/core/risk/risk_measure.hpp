#pragma once

#include "slalom/core/risk/risk_options.hpp"

namespace slalom {

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
