#pragma once

#include <cmath>
#include <vector>

#include "slalom/solvers/svg_mppi_options.hpp"

/// Variances that options leave open (0).
namespace slalom::detail {

/// Returns `given`, one value for each input, with `other(input)` where it is 0.
template <class Other>
PerInput filled(const PerInput& given, int inputs, Other&& other) {
  std::vector<double> values(static_cast<std::size_t>(inputs));
  for (int i = 0; i < inputs; ++i) values[static_cast<std::size_t>(i)] = given[i] > 0 ? given[i] : other(i);
  return values;
}

/// Replaces variances of 0: the standard deviation becomes a quarter of the range between the bounds, or 1
/// where there is none. The least variance becomes the fraction 1e-4 of the variance.
template <class Options>
Options with_variances(Options o, int inputs) {
  o.variance = filled(o.variance, inputs, [&](int i) {
    const double range = o.input_max[i] - o.input_min[i];
    return range > 0 && std::isfinite(range) ? range * range / 16 : 1.0;
  });
  if constexpr (requires { o.elite_share; })
    o.variance_min = filled(o.variance_min, inputs, [&](int i) { return 1e-4 * o.variance[i]; });
  return o;
}

/// Replaces also the variances of guides, which are shares of `variance`.
inline SvgMppiOptions with_guide_variances(const SvgMppiOptions& options, int inputs) {
  SvgMppiOptions o = with_variances(options, inputs);
  const auto share = [&](PerInput& value, double part, const PerInput& of) {
    value = filled(value, inputs, [&](int i) { return part * of[i]; });
  };
  share(o.variance_max, 1, o.variance);
  share(o.variance_min, 0.25, o.variance);
  share(o.guides.variance, 0.5, o.variance);
  share(o.guides.restart_variance, 1, o.variance);
  share(o.guides.gradient_variance, 0.5, o.variance);
  share(o.guides.step, 0.5, o.guides.gradient_variance);
  return o;
}

}  // namespace slalom::detail
