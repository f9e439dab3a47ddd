#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `mppi`, model predictive path integral control. Defaults are the method of Williams et al.
/// (2018) without control term, and a temperature from the costs. `visit_options` below describes the fields.
struct MppiOptions {
  static constexpr const char* method = "mppi";  ///< name in configurations

  int horizon = 30;
  int samples = 1024;
  double temperature = 0;
  PerInput variance = 0;
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();
  NoiseOptions noise{};          ///< shape of the noise; white and normal
  WeightingOptions weighting{};  ///< how costs become weights; exponentially
  double control_cost_discount = 1;
  double zero_mean_share = 0;
  bool shift_warm_start = true;
  std::uint64_t seed = 0;
  int threads = 1;
  PublishedMppi published{};  ///< only to reproduce the program of proj-svg_mppi
};

template <class Options, class Visit>
requires is_options_of<Options, MppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_noise_options(o.noise, visit);
  detail::visit_weighting_options(o.weighting, visit);
  detail::visit_control_cost_options(o, visit);
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const MppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
