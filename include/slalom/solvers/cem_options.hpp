#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `cem`, the cross-entropy method (Rubinstein 1999; for control: Kobilarov 2012): the
/// distribution is refitted to its best samples several times per solve.
struct CemOptions {
  static constexpr const char* method = "cem";  ///< name in configurations

  int horizon = 30;       ///< T, steps
  int samples = 512;      ///< K, drawn in each iteration
  PerInput variance = 1;  ///< Sigma at the start of every solve, input^2
  PerInput input_min = -std::numeric_limits<double>::infinity();  ///< lower bounds of the inputs
  PerInput input_max = std::numeric_limits<double>::infinity();   ///< upper bounds of the inputs

  int iterations = 5;  ///< refits of the distribution in a solve
  double elite_share =
      0.1;                 ///< share of the samples that the distribution is refitted to; at least one sample
  double smoothing = 0.1;  ///< share of the old distribution that is kept in an update
  PerInput variance_min = 1e-4;  ///< least variance, input^2
  bool send_best = false;        ///< the solution is the best sample seen instead of the mean

  NoiseOptions noise{};          ///< shape of the noise; white and normal
  double zero_mean_share = 0;    ///< of the samples, drawn around zero instead of the mean
  bool shift_warm_start = true;  ///< move the last solution forward by the elapsed time
  std::uint64_t seed = 0;        ///< seed of the random numbers
  int threads = 1;               ///< threads that work on a solve; the result does not depend on it
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, CemOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_cross_entropy_options(o, visit);
  detail::visit_noise_options(o.noise, visit);
  visit_run_options(o, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const CemOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
