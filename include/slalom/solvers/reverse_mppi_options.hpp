#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// Ways to pick samples by their probability.
enum class Resampling {
  systematic,  ///< at equal distances along the cumulated probabilities: as often as expected, up to rounding
  multinomial,  ///< independently, with replacement
};
inline const char* const* enum_names(Resampling) {
  static constexpr const char* const names[] = {"systematic", "multinomial", nullptr};
  return names;
}

/// Options of `reverse_mppi`: mirror descent on the reverse KL divergence (Kobayashi and Fukumoto 2022).
/// `visit_options` below describes the fields.
struct ReverseMppiOptions {
  static constexpr const char* method = "reverse_mppi";  ///< name in configurations

  int horizon = 30;
  int samples = 256;  ///< control sequences evaluated in each iteration
  double temperature = 1;
  PerInput variance = 1;  ///< variance at the start of every solve
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int iterations = 20;
  double step = 0.2;
  double negative_ratio = 0.5;
  bool reject_samples = true;
  double inflation = 2;
  Resampling resampling = Resampling::systematic;
  double warm_start = 0.5;
  PerInput variance_min = 1e-4;

  double control_cost_discount = 0;
  double zero_mean_share = 0;
  bool shift_warm_start = true;
  std::uint64_t seed = 0;
  int threads = 1;
  PublishedReverseMppi published{};  ///< only to reproduce the program of proj-svg_mppi
};

template <class Options, class Visit>
requires is_options_of<Options, ReverseMppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(o.iterations, {"iterations", "", "updates of the distribution in a solve", 1, 10000});
  visit(o.step, {"step", "", "step size of the mirror descent; 1 takes the weighted mean", 0, 2, "eta"});
  visit(o.negative_ratio, {"negative_ratio", "", "weight of the repulsion from bad samples", 0, 10});
  visit(o.reject_samples, {"reject_samples", "", "draw more samples and keep those away from bad ones"});
  visit(o.inflation, {"inflation", "", "samples drawn for each one that is kept", 1, 100});
  visit(o.resampling, {"resampling", "", "how samples are selected by their probability"});
  visit(o.warm_start,
        {"warm_start", "", "share of the new distribution in the initial one of the next solve", 0, 1});
  visit(o.variance_min, {"variance_min", "input^2", "least variance", 0, detail::finite});
  detail::visit_control_cost_options(o, visit);
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const ReverseMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
