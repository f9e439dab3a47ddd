#include "slalom/navigation/navigator.hpp"

namespace slalom::navigation {

namespace {

template <class Options>
Options sampling_options(const BaseOptions& base) {
  const auto variances = [&](double share) {
    const double forward = share * base.max_forward, left = share * base.max_sideways,
                 turn = share * base.max_turn;
    if (base.kind == BaseKind::omnidirectional) return PerInput{forward * forward, left * left, turn * turn};
    return PerInput{forward * forward, turn * turn};
  };
  Options options;
  options.horizon = 56;
  options.samples = 2000;
  options.temperature = 0.03;
  options.variance = variances(0.4);
  options.noise.exponent = 1;
  options.control_cost_discount = 1;
  if constexpr (requires { options.guides; }) {
    options.variance_min = variances(0.15);
    options.variance_max = variances(0.4);
    options.guides.variance = options.guides.restart_variance = variances(0.4);
    options.guides.gradient_variance = variances(0.1);
    options.guides.step = options.guides.gradient_variance;
    options.guides.gradient_temperature = options.temperature;
    options.guides.iterations = 5;
    options.guides.gradient_samples = 64;
  }
  return options;
}

}  // namespace

SvgMppiOptions svg_mppi_options(const BaseOptions& base) {
  return sampling_options<SvgMppiOptions>(base);
}

MppiOptions mppi_options(const BaseOptions& base) {
  return sampling_options<MppiOptions>(base);
}

}  // namespace slalom::navigation
