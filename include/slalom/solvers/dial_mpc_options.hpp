#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `dial_mpc` (Xue et al., "Full-Order Sampling-Based MPC for Torque-Level Locomotion Control via
/// Diffusion-Style Annealing", arXiv 2409.15610, section III-C and algorithm 1): several updates of MPPI in a
/// solve, without control term. Their noise shrinks from one update to the next, and it is smaller at the
/// start of the horizon than at its end.
struct DialMpcOptions {
  static constexpr const char* method = "dial_mpc";  ///< name in configurations

  int horizon = 30;        ///< T, steps
  int samples = 512;       ///< K, control sequences drawn in an update
  double temperature = 1;  ///< lambda
  PerInput variance = 1;   ///< Sigma of the first update at the last step, input^2
  PerInput input_min = -std::numeric_limits<double>::infinity();  ///< lower bounds of the inputs
  PerInput input_max = std::numeric_limits<double>::infinity();   ///< upper bounds of the inputs

  int iterations = 2;            ///< N, updates in a solve
  int first_iterations = 10;     ///< updates in the first solve, which has no last solution
  double iteration_decay = 0.5;  ///< factor of the standard deviation from one update to the next
  double horizon_decay = 0.66;   ///< factor of the standard deviation from the last step to the first

  NoiseOptions noise{};          ///< shape of the noise; white and normal
  WeightingOptions weighting{};  ///< how costs become weights; exponentially
  SmoothingOptions smoothing{};  ///< of the solution; none
  double zero_mean_share = 0;    ///< of the samples, drawn around zero instead of the last solution
  bool shift_warm_start = true;  ///< move the last solution forward by the elapsed time
  std::uint64_t seed = 0;        ///< seed of the random numbers
  int threads = 1;               ///< threads that work on a solve; the result does not depend on it
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, DialMpcOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(
      o.iterations,
      Declaration{.name = "iterations", .symbol = "N", .help = "updates in a solve", .min = 1, .max = 1000});
  visit(o.first_iterations, Declaration{.name = "first_iterations",
                                        .help = "updates in the first solve, which has no last solution",
                                        .min = 1,
                                        .max = 1000});
  visit(o.iteration_decay,
        Declaration{.name = "iteration_decay",
                    .help = "factor of the samples' standard deviation from one update to the next",
                    .min = 1e-3,
                    .max = 1});
  visit(o.horizon_decay,
        Declaration{.name = "horizon_decay",
                    .help = "factor of the samples' standard deviation from the last step to the first",
                    .min = 1e-3,
                    .max = 1});
  detail::visit_noise_options(o.noise, visit);
  detail::visit_weighting_options(o.weighting, visit);
  detail::visit_smoothing_options(o.smoothing, visit);
  visit_run_options(o, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const DialMpcOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
