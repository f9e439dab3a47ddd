#include "slalom/core/risk/risk_measure.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom {
namespace {

// All loops run over the samples innermost, so that the compiler makes SIMD instructions of them.

void replace_not_a_number(VariantCosts& costs, int variants, int count) noexcept {
  constexpr float infinite = std::numeric_limits<float>::infinity();
  for (int m = 0; m < variants; ++m)
    for (int i = 0; i < count; ++i)
      costs.values[m][i] = costs.values[m][i] == costs.values[m][i] ? costs.values[m][i] : infinite;
}

/// The sum over the variants, each weighted by weight(m).
template <class Weight>
void add_weighted(const VariantCosts& costs, int variants, int count, Weight&& weight, float* to) noexcept {
  std::fill_n(to, count, 0.0f);
  for (int m = 0; m < variants; ++m) {
    const float share = weight(m);
    if (share == 0) continue;
    for (int i = 0; i < count; ++i) to[i] += share * costs.values[m][i];
  }
}

void find_worst(const VariantCosts& costs, int variants, int count, float* to) noexcept {
  std::copy_n(costs.values[0], count, to);
  for (int m = 1; m < variants; ++m)
    for (int i = 0; i < count; ++i) to[i] = std::max(to[i], costs.values[m][i]);
}

/// Moves the `worst` largest costs of every sample to the front, in descending order.
void sort_worst_first(VariantCosts& costs, int variants, int worst, int count) noexcept {
  for (int front = 0; front < worst; ++front) {
    float* const largest = costs.values[front];
    for (int m = front + 1; m < variants; ++m) {
      float* const other = costs.values[m];
      for (int i = 0; i < count; ++i) {
        const float high = std::max(largest[i], other[i]), low = std::min(largest[i], other[i]);
        largest[i] = high;
        other[i] = low;
      }
    }
  }
}

void conditional_value_at_risk(VariantCosts& costs, int variants, int count, double tail,
                               float* to) noexcept {
  const double counted = std::clamp(tail * variants, 1e-3, static_cast<double>(variants));
  const int worst = saturate_cast<int>(std::ceil(counted));
  sort_worst_first(costs, variants, worst, count);
  add_weighted(
      costs, worst, count, [&](int m) { return static_cast<float>(std::min(counted - m, 1.0) / counted); },
      to);
}

void entropic_risk(const VariantCosts& costs, int variants, int count, double aversion, float* to) noexcept {
  find_worst(costs, variants, count, to);
  for (int i = 0; i < count; ++i) {
    if (!std::isfinite(to[i])) continue;
    // The largest cost is taken out of the sum, so that no exponential overflows.
    double sum = 0;
    for (int m = 0; m < variants; ++m)
      sum += std::exp(aversion * (static_cast<double>(costs.values[m][i]) - static_cast<double>(to[i])));
    to[i] += static_cast<float>(std::log(sum / variants) / aversion);
  }
}

}  // namespace

void measure_risk(VariantCosts& costs, int count, const RiskOptions& options, float* to) noexcept {
  const int variants = options.variants;
  replace_not_a_number(costs, variants, count);
  switch (options.measure) {
    case RiskMeasure::mean:
      return add_weighted(
          costs, variants, count, [&](int) { return 1.0f / static_cast<float>(variants); }, to);
    case RiskMeasure::worst:
      return find_worst(costs, variants, count, to);
    case RiskMeasure::cvar:
      return conditional_value_at_risk(costs, variants, count, options.tail, to);
    case RiskMeasure::exponential:
      return entropic_risk(costs, variants, count, options.aversion, to);
  }
}

}  // namespace slalom
