
#include "slalom/navigation/navigator.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/reverse_mppi_options.hpp"
#include "slalom/solvers/sv_mpc_options.hpp"

namespace slalom::navigation {
namespace {

/// Variances whose standard deviations are a share of the limits of the base; any where it does not turn.
PerInput variances(const BaseOptions& base, double share, double share_of_turn) {
  const double forward = share * base.max_forward, left = share * base.max_sideways,
               turn = share_of_turn * (base.max_turn > 0 ? base.max_turn : 1);
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
  set(options, "samples", 3000);
  set(options, "temperature", 0.1);
  set(options, "variance", variances(base, 0.4, 0.2));
  set(options, "gradient_variance", variances(base, 0.1, 0.1));
  set(options, "noise_exponent", PerInput(4));
  set(options, "noise_pinned", true);
  set(options, "control_cost_discount", 1.0);
}

/// The rollouts of a solve with these options, divided by its samples.
int rollouts_per_sample(const SolverOptions& options) {
  if (const auto* reverse = options.get_if<ReverseMppiOptions>()) return reverse->iterations;
  const auto* stein = options.get_if<SvMpcOptions>();
  return stein ? 1 + stein->iterations * stein->gradient_samples : 1;
}

}  // namespace

SvgMppiOptions svg_mppi_options(const BaseOptions& base) {
  SolverOptions shared = solver_options(SvgMppiOptions::method);
  set_shared(shared, base);
  SvgMppiOptions options = *shared.get_if<SvgMppiOptions>();
  options.variance_min = variances(base, 0.15, 0.15);
  options.variance_max = variances(base, 0.4, 0.2);
  options.guides.variance = variances(base, 0.05, 0.05);
  options.guides.step = variances(base, 0.06, 0.06);  // about a third of a step to the samples' mean
  options.guides.gradient_temperature = options.temperature;
  options.guides.count = 1;  // the best of several changes from solve to solve, and with it the variances
  options.guides.iterations = 2;
  options.batches = 1;
  options.guides.gradient_samples = 64;
  return options;
}

SolverOptions method_options(std::string_view method, const BaseOptions& base) {
  if (method == SvgMppiOptions::method) return svg_mppi_options(base);
  SolverOptions options = solver_options(method);
  set_shared(options, base);
  const SvgMppiOptions svg_mppi = svg_mppi_options(base);
  const GuideOptions& guides = svg_mppi.guides;
  set(options, "samples",
      (svg_mppi.samples + guides.count * guides.iterations * guides.gradient_samples) /
          rollouts_per_sample(options));
  return options;
}

}  // namespace slalom::navigation
