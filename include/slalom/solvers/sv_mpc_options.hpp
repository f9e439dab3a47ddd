#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_declarations.hpp"

namespace slalom {

/// What the bandwidth of the kernel between particles is taken from.
enum class BandwidthModel {
  pair_distances,  ///< median squared distance between particles / log n (Liu and Wang 2016)
  squared_norms,   ///< median squared norm of the particles / log n (published program)
};
inline const char* const* enum_names(BandwidthModel) {
  static constexpr const char* const names[] = {"pair_distances", "squared_norms", nullptr};
  return names;
}

/// Options of `sv_mpc`. Defaults are the correct form of the method (Lambert et al., CoRL 2020); "published"
/// is the value, or the form, of the published program of Honda et al. (ICRA 2024).
struct SvMpcOptions {
  int horizon = 30;        ///< T, steps; published: 14 (15 states)
  int samples = 128;       ///< particles n; published: 500
  double temperature = 1;  ///< lambda; published: 3
  PerInput variance = 1;   ///< of the prior at the start, input^2; published: 0.1
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int iterations = 5;  ///< of SVGD; published: 3
  PerInput step = 1;   ///< epsilon, input^2; published: 0.5
  /// Keep the step below 1 / (Sigma^-1 + Sigma_g^-1), the inverse curvature of the log posterior as it is
  /// known, so that particles cannot overshoot further and further. Published: false.
  bool limit_step = true;
  int gradient_samples = 16;          ///< a particle; published: 10
  PerInput gradient_variance = 0.25;  ///< Sigma_g, input^2; published: 0.01
  /// Add the control term of the weights to the costs in a gradient. Published: true, though the prior has
  /// its own gradient.
  bool gradient_control_term = false;
  bool best_particle =
      false;  ///< the solution is the particle of largest weight instead of the weighted mean
  BandwidthModel bandwidth = BandwidthModel::pair_distances;  ///< published: squared_norms
  /// Gradient of the log prior with the inverse of the inverse variance and the wrong sign. Published: true.
  bool inverted_prior = false;
  bool subtract_minimum = true;  ///< see svg_mppi; published: false
  double gradient_floor = 0;     ///< published: 1e-10
  bool clamp_particles = true;   ///< keep particles within the bounds; published: false
  /// Measure the prior's new variances in units of the old, but use them as variances all the same.
  /// Published: true.
  bool dimensionless_variance = false;
  PerInput variance_min = 0.1;  ///< input^2, of the prior; published: 0

  double control_cost_discount = 0;    ///< alpha; published: 0.1
  double zero_mean_share = 0;          ///< published: 0.1
  double inverse_variance_offset = 0;  ///< 1/input^2; published: 1e-4
  double normaliser_offset = 0;        ///< published: 1e-10
  bool shift_warm_start = true;        ///< published: false
  std::uint64_t seed = 0;
  int threads = 1;
};

template <class Options, class Visit>
requires is_options_of<Options, SvMpcOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(o.iterations,
        Declaration{.name = "iterations", .help = "SVGD steps in a solve", .min = 1, .max = 10000});
  visit(o.step, Declaration{.name = "step",
                            .symbol = "epsilon",
                            .unit = "input^2",
                            .help = "step size of SVGD",
                            .min = 0,
                            .max = detail::finite});
  visit(o.limit_step, Declaration{.name = "limit_step",
                                  .help = "keep the step below the inverse curvature; published: false"});
  visit(o.gradient_samples, Declaration{.name = "gradient_samples",
                                        .symbol = "N",
                                        .help = "samples for the gradient of a particle",
                                        .min = 1,
                                        .max = 65536});
  visit(o.gradient_variance, Declaration{.name = "gradient_variance",
                                         .symbol = "Sigma_g",
                                         .unit = "input^2",
                                         .help = "variance of the samples for the gradient",
                                         .min = 0,
                                         .max = detail::finite});
  visit(o.gradient_control_term,
        Declaration{.name = "gradient_control_term",
                    .help = "count the control term in gradients, beside the prior; published: true"});
  visit(o.best_particle,
        Declaration{.name = "best_particle",
                    .help = "send the particle of largest weight instead of the weighted mean"});
  visit(o.bandwidth,
        Declaration{.name = "bandwidth", .symbol = "h", .help = "what the kernel's bandwidth is taken from"});
  visit(o.inverted_prior,
        Declaration{.name = "inverted_prior",
                    .help = "gradient of the prior with wrong sign and scale; published: true"});
  visit(o.subtract_minimum,
        Declaration{.name = "subtract_minimum",
                    .help = "weights of a gradient relative to its best sample; published: false"});
  visit(o.gradient_floor, Declaration{.name = "gradient_floor",
                                      .help = "added to the sum of a gradient's weights; published: 1e-10",
                                      .min = 0,
                                      .max = 1});
  visit(o.clamp_particles,
        Declaration{.name = "clamp_particles", .help = "keep particles within the bounds; published: false"});
  visit(o.dimensionless_variance,
        Declaration{.name = "dimensionless_variance",
                    .help = "measure new variances in units of the old; published: true"});
  visit(o.variance_min, Declaration{.name = "variance_min",
                                    .unit = "input^2",
                                    .help = "least variance of the prior",
                                    .min = 0,
                                    .max = detail::finite});
  detail::visit_control_cost_options(o, visit);
  detail::visit_run_options(o, visit);
}

}  // namespace slalom
