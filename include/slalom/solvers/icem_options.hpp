#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `icem`, the improved cross-entropy method (Pinneri et al., "Sample-efficient Cross-Entropy
/// Method for Real-time Planning", CoRL 2020): `cem` with coloured noise, with elites that stay in the next
/// iteration and the next solve, with fewer samples from iteration to iteration, and with the mean as a
/// sample of the last one. The best sequence seen is sent.
struct IcemOptions {
  static constexpr const char* method = "icem";  ///< name in configurations

  int horizon = 30;       ///< T, steps
  int samples = 320;      ///< K, drawn in the first iteration
  PerInput variance = 1;  ///< Sigma at the start of every solve, input^2
  PerInput input_min = -std::numeric_limits<double>::infinity();  ///< lower bounds of the inputs
  PerInput input_max = std::numeric_limits<double>::infinity();   ///< upper bounds of the inputs

  int iterations = 5;         ///< refits of the distribution in a solve
  double elite_share = 0.03;  ///< share of the first iteration's samples that the distribution is refitted to
  double smoothing = 0.1;     ///< share of the old distribution that is kept in an update
  PerInput variance_min = 1e-4;   ///< least variance, input^2
  double kept_elite_share = 0.3;  ///< xi, share of the elites that stay as samples
  double sample_decay = 1.25;     ///< gamma, factor by which every iteration has fewer samples
  bool send_best = true;          ///< the solution is the best sample seen instead of the mean

  NoiseOptions noise{.exponent = 2};  ///< shape of the noise; coloured and normal
  double zero_mean_share = 0;         ///< of the samples, drawn around zero instead of the mean
  bool shift_warm_start = true;       ///< move the last solution and elites forward by the elapsed time
  std::uint64_t seed = 0;             ///< seed of the random numbers
  int threads = 1;                    ///< threads that work on a solve; the result does not depend on it
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, IcemOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_cross_entropy_options(o, visit);
  visit(o.kept_elite_share, Declaration{.name = "kept_elite_share",
                                        .symbol = "xi",
                                        .help = "share of the elites that stay as samples of the next "
                                                "iteration and of the next solve",
                                        .min = 0,
                                        .max = 1});
  visit(o.sample_decay, Declaration{.name = "sample_decay",
                                    .symbol = "gamma",
                                    .help = "every iteration has fewer samples by this factor, and at least "
                                            "twice the elites",
                                    .min = 1,
                                    .max = 100});
  detail::visit_noise_options(o.noise, visit);
  visit_run_options(o, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const IcemOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
