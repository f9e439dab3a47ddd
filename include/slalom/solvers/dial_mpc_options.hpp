#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `dial_mpc` (Xue et al., "Full-Order Sampling-Based MPC for Torque-Level Locomotion Control via
/// Diffusion-Style Annealing", arXiv 2409.15610, section III-C and algorithm 1): several updates of MPPI in a
/// solve, without control term. Their noise shrinks from one update to the next, and it is smaller at the
/// start of the horizon than at its end. `visit_options` below describes the fields.
struct DialMpcOptions {
  static constexpr const char* method = "dial_mpc";  ///< name in configurations

  int horizon = 30;
  int samples = 1024;  ///< control sequences drawn in a solve, equally many in each update
  double temperature = 0;
  PerInput variance = 0;  ///< variance in the first update, at the last step
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int iterations = 2;
  int first_iterations = 10;
  double iteration_decay = 0.5;
  double horizon_decay = 0.66;

  NoiseOptions noise{};          ///< shape of the noise; white and normal
  WeightingOptions weighting{};  ///< how costs become weights; exponentially
  double zero_mean_share = 0;
  bool shift_warm_start = true;
  std::uint64_t seed = 0;
  int threads = 1;
};

template <class Options, class Visit>
requires is_options_of<Options, DialMpcOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(o.iterations, {"iterations", "", "updates in a solve", 1, 1000, "N"});
  visit(o.first_iterations,
        {"first_iterations", "", "updates in the first solve, which has no last solution", 1, 1000});
  visit(o.iteration_decay,
        {"iteration_decay", "", "factor of the samples' standard deviation from one update to the next", 1e-3,
         1});
  visit(o.horizon_decay,
        {"horizon_decay", "", "factor of the samples' standard deviation from the last step to the first",
         1e-3, 1});
  detail::visit_noise_options(o.noise, visit);
  detail::visit_weighting_options(o.weighting, visit);
  visit_run_options(o, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const DialMpcOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
