#include "slalom/navigation/navigator.hpp"
#include "slalom/solvers/registry.hpp"

namespace slalom::navigation {

namespace {

/// Variances whose standard deviations are a share of the limits of the base.
PerInput variances(const BaseOptions& base, double share) {
  const double forward = share * base.max_forward, left = share * base.max_sideways,
               turn = share * base.max_turn;
  if (base.kind == BaseKind::omnidirectional) return {forward * forward, left * left, turn * turn};
  return {forward * forward, turn * turn};
}

template <class Type>
void set(SolverOptions& options, const char* name, const Type& value) {
  if (Type* const option = options.find<Type>(name)) *option = value;
}

/// Sets the options that methods share, where a method has them.
void set_shared(SolverOptions& options, const BaseOptions& base) {
  set(options, "horizon", 56);
  set(options, "samples", 2000);
  set(options, "temperature", 0.03);
  set(options, "variance", variances(base, 0.4));
  set(options, "gradient_variance", variances(base, 0.1));
  set(options, "noise_exponent", PerInput(1));
  set(options, "control_cost_discount", 1.0);
}

}  // namespace

SvgMppiOptions svg_mppi_options(const BaseOptions& base) {
  SolverOptions shared = solver_options(SvgMppiOptions::method);
  set_shared(shared, base);
  SvgMppiOptions options = *shared.get_if<SvgMppiOptions>();
  options.variance_min = variances(base, 0.15);
  options.variance_max = variances(base, 0.4);
  options.guides.variance = options.guides.restart_variance = variances(base, 0.4);
  options.guides.step = options.guides.gradient_variance;
  options.guides.gradient_temperature = options.temperature;
  options.guides.iterations = 5;
  options.guides.gradient_samples = 64;
  return options;
}

MppiOptions mppi_options(const BaseOptions& base) {
  SolverOptions shared = solver_options(MppiOptions::method);
  set_shared(shared, base);
  return *shared.get_if<MppiOptions>();
}

SolverOptions method_options(std::string_view method, const BaseOptions& base) {
  if (method == SvgMppiOptions::method) return svg_mppi_options(base);
  SolverOptions options = solver_options(method);
  set_shared(options, base);
  return options;
}

}  // namespace slalom::navigation
