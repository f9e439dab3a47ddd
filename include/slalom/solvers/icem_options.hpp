#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Options of `icem`, the improved cross-entropy method (Pinneri et al., "Sample-efficient Cross-Entropy
/// Method for Real-time Planning", CoRL 2020): `cem` with coloured noise, with elites that stay in the next
/// iteration and the next solve, with fewer samples from iteration to iteration, and with the mean as a
/// sample of the last one. The best sequence seen is sent. `visit_options` below describes the fields.
struct IcemOptions {
  static constexpr const char* method = "icem";  ///< name in configurations

  int horizon = 30;
  int samples = 1024;     ///< control sequences drawn in a solve, the most of them in the first iteration
  PerInput variance = 0;  ///< variance at the start of every solve
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int iterations = 5;
  double elite_share = 0.03;  ///< share of the first iteration's samples
  double smoothing = 0.1;
  PerInput variance_min = 0;
  double kept_elite_share = 0.3;
  double sample_decay = 1.25;
  bool send_best = true;

  NoiseOptions noise{.exponent = 2};  ///< shape of the noise; coloured and normal
  double zero_mean_share = 0;
  bool shift_warm_start = true;  ///< The elites move, too.
  std::uint64_t seed = 0;
  int threads = 1;
};

template <class Options, class Visit>
requires is_options_of<Options, IcemOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_cross_entropy_options(o, visit);
  visit(o.kept_elite_share,
        {"kept_elite_share", "", "share of the elites that stay as samples of the next iteration and solve",
         0, 1, "xi"});
  visit(o.sample_decay,
        {"sample_decay", "",
         "factor by which every iteration has fewer samples; at least twice the elites remain", 1, 100,
         "gamma"});
  detail::visit_noise_options(o.noise, visit);
  visit_run_options(o, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const IcemOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
