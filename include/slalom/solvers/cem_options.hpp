#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `cem`, the cross-entropy method (Rubinstein 1999; for control: Kobilarov 2012): the
/// distribution is refitted to its best samples in a solve. `visit_options` below describes the fields.
struct CemOptions {
  static constexpr const char* method = "cem";  ///< name in configurations

  int horizon = 30;
  int samples = 1024;     ///< control sequences drawn in a solve, a part in each iteration
  PerInput variance = 0;  ///< variance at the start of every solve
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int iterations = 5;
  double elite_share = 0.1;
  double smoothing = 0.1;
  PerInput variance_min = 0;
  bool send_best = false;

  NoiseOptions noise{};  ///< shape of the noise; white and normal
  double zero_mean_share = 0;
  bool shift_warm_start = true;
  std::uint64_t seed = 0;
  int threads = 1;
};

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
