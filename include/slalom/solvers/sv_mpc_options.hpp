#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// `sv_mpc`: Stein variational MPC (Lambert et al., CoRL 2020). `visit_options` below describes the fields.
struct SvMpcOptions {
  static constexpr const char* method = "sv_mpc";  ///< name in configurations

  int horizon = 30;
  int samples = 128;  ///< number of particles
  double temperature = 1;
  PerInput variance = 1;  ///< variance of the prior at the start
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int iterations = 5;
  PerInput step = 1;
  /// The inverse curvature is 1 / (Sigma^-1 + Sigma_g^-1), that of the log posterior as far as it is known:
  /// particles then cannot overshoot further and further.
  bool limit_step = true;
  int gradient_samples = 16;
  PerInput gradient_variance = 0.25;
  bool best_particle = false;
  PerInput variance_min = 0.1;

  double control_cost_discount = 0;
  double zero_mean_share = 0;    ///< share of a gradient's samples drawn around zero, not the particle
  bool shift_warm_start = true;  ///< The particles move, too.
  std::uint64_t seed = 0;
  int threads = 1;
  PublishedSvMpc published{};  ///< only to reproduce the program of proj-svg_mppi
};

template <class Options, class Visit>
requires is_options_of<Options, SvMpcOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(o.iterations, {"iterations", "", "SVGD steps in a solve", 1, 10000});
  visit(o.step, {"step", "input^2", "step size of SVGD", 0, detail::finite, "epsilon"});
  visit(o.limit_step, {"limit_step", "", "keep the step below the inverse curvature"});
  visit(o.gradient_samples,
        {"gradient_samples", "", "samples for the gradient of a particle", 1, 65536, "N"});
  visit(o.gradient_variance, {"gradient_variance", "input^2", "variance of the samples for the gradient", 0,
                              detail::finite, "Sigma_g"});
  visit(o.best_particle,
        {"best_particle", "", "send the particle of largest weight instead of the weighted mean"});
  visit(o.variance_min, {"variance_min", "input^2", "least variance of the prior", 0, detail::finite});
  detail::visit_control_cost_options(o, visit);
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const SvMpcOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
