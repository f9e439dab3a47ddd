#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `mppi`, model predictive path integral control. Defaults are the method of Williams et al.
/// (2018).
struct MppiOptions {
  static constexpr const char* method = "mppi";  ///< name in configurations

  int horizon = 30;                                               ///< T, steps
  int samples = 1024;                                             ///< K, control sequences drawn in a solve
  double temperature = 1;                                         ///< lambda
  PerInput variance = 1;                                          ///< Sigma, input^2
  PerInput input_min = -std::numeric_limits<double>::infinity();  ///< lower bounds of the inputs
  PerInput input_max = std::numeric_limits<double>::infinity();   ///< upper bounds of the inputs
  NoiseOptions noise{};                                           ///< shape of the noise; white and normal
  WeightingOptions weighting{};                                   ///< how costs become weights; exponentially
  SmoothingOptions smoothing{};                                   ///< of the solution; none
  double control_cost_discount = 0;  ///< alpha: the control term is multiplied by 1 - alpha
  double zero_mean_share = 0;        ///< of the samples, drawn around zero instead of the last solution
  bool shift_warm_start = true;      ///< move the last solution forward by the elapsed time
  /// Mean of the samples and nominal sequence are the best of the proposals and the last solution, so that
  /// there is no control term; the proposals are no samples.
  bool nominal_from_proposals = false;
  std::uint64_t seed = 0;     ///< seed of the random numbers
  int threads = 1;            ///< threads that work on a solve; the result does not depend on it
  PublishedMppi published{};  ///< only to reproduce the program of proj-svg_mppi
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, MppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_noise_options(o.noise, visit);
  detail::visit_weighting_options(o.weighting, visit);
  detail::visit_smoothing_options(o.smoothing, visit);
  detail::visit_control_cost_options(o, visit);
  visit(
      o.nominal_from_proposals,
      Declaration{.name = "nominal_from_proposals",
                  .help = "draw the samples around the best of the proposals and the last solution, which is "
                          "the nominal sequence; otherwise proposals are samples"});
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const MppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
