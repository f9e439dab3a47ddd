#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `sv_mpc`: Stein variational MPC (Lambert et al., CoRL 2020).
struct SvMpcOptions {
  static constexpr const char* method = "sv_mpc";  ///< name in configurations

  int horizon = 30;                                               ///< T, steps
  int samples = 128;                                              ///< number of particles n
  double temperature = 1;                                         ///< lambda
  PerInput variance = 1;                                          ///< of the prior at the start, input^2
  PerInput input_min = -std::numeric_limits<double>::infinity();  ///< lower bounds of the inputs
  PerInput input_max = std::numeric_limits<double>::infinity();   ///< upper bounds of the inputs

  int iterations = 5;  ///< SVGD steps in a solve
  PerInput step = 1;   ///< epsilon, input^2
  /// Keep the step below 1 / (Sigma^-1 + Sigma_g^-1), the inverse curvature of the log posterior as far as it
  /// is known, so that particles cannot overshoot further and further.
  bool limit_step = true;
  /// Control points for each input: a particle is then a cubic B-spline along the horizon (of a lower degree
  /// with fewer than four), and all variances are those of control points. At most the horizon counts. 0: a
  /// particle has inputs of its own for each step.
  int control_points = 0;
  int gradient_samples = 16;          ///< N, for the gradient of a particle
  PerInput gradient_variance = 0.25;  ///< Sigma_g, input^2
  bool best_particle = false;         ///< send the particle of largest weight instead of the weighted mean
  PerInput variance_min = 0.1;        ///< least variance of the prior, input^2

  double control_cost_discount = 0;  ///< alpha: the control term is multiplied by 1 - alpha
  double zero_mean_share = 0;        ///< of a gradient's samples, drawn around zero instead of the particle
  bool shift_warm_start = true;      ///< move the particles and the last solution forward by the elapsed time
  std::uint64_t seed = 0;            ///< seed of the random numbers
  int threads = 1;                   ///< threads that work on a solve; the result does not depend on it
  PublishedSvMpc published{};        ///< only to reproduce the program of proj-svg_mppi
};

/// Declares the options above.
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
  visit(o.limit_step, Declaration{.name = "limit_step", .help = "keep the step below the inverse curvature"});
  visit(o.control_points, Declaration{.name = "control_points",
                                      .symbol = "n",
                                      .help = "control points for each input: a particle is then a cubic "
                                              "B-spline along the horizon; 0: inputs for each step",
                                      .min = 0,
                                      .max = 64});
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
  visit(o.best_particle,
        Declaration{.name = "best_particle",
                    .help = "send the particle of largest weight instead of the weighted mean"});
  visit(o.variance_min, Declaration{.name = "variance_min",
                                    .unit = "input^2",
                                    .help = "least variance of the prior",
                                    .min = 0,
                                    .max = detail::finite});
  detail::visit_control_cost_options(o, visit);
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const SvMpcOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
