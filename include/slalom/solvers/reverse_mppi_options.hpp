#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// How samples are picked by their probability.
enum class Resampling {
  systematic,  ///< at equal distances along the cumulated probabilities: as often as expected, up to rounding
  multinomial,  ///< independently, with replacement
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(Resampling) {
  static constexpr const char* const names[] = {"systematic", "multinomial", nullptr};
  return names;
}

/// Options of `reverse_mppi`: mirror descent on the reverse KL divergence (Kobayashi and Fukumoto 2022).
struct ReverseMppiOptions {
  static constexpr const char* method = "reverse_mppi";  ///< name in configurations

  int horizon = 30;                                               ///< T, steps
  int samples = 256;                                              ///< K, evaluated in each iteration
  double temperature = 1;                                         ///< lambda
  PerInput variance = 1;                                          ///< Sigma at the start, input^2
  PerInput input_min = -std::numeric_limits<double>::infinity();  ///< lower bounds of the inputs
  PerInput input_max = std::numeric_limits<double>::infinity();   ///< upper bounds of the inputs

  int iterations = 20;                             ///< updates of the distribution in a solve
  double step = 0.2;                               ///< eta of the mirror descent
  double negative_ratio = 0.5;                     ///< weight of the repulsion from bad samples
  bool reject_samples = true;                      ///< draw more samples and keep those away from bad ones
  double inflation = 2;                            ///< samples drawn for each one that is kept
  Resampling resampling = Resampling::systematic;  ///< how samples are selected by their probability
  double warm_start = 0.5;       ///< share of the new distribution in the initial one of the next solve
  PerInput variance_min = 1e-4;  ///< least variance, input^2

  double control_cost_discount = 0;  ///< alpha: the control term is multiplied by 1 - alpha
  double zero_mean_share = 0;        ///< of the samples, drawn around zero instead of the mean
  bool shift_warm_start = true;      ///< move the last solution forward by the elapsed time
  std::uint64_t seed = 0;            ///< seed of the random numbers
  int threads = 1;                   ///< threads that work on a solve; the result does not depend on it
  PublishedReverseMppi published{};  ///< only to reproduce the program of proj-svg_mppi
};

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, ReverseMppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(o.iterations,
        Declaration{
            .name = "iterations", .help = "updates of the distribution in a solve", .min = 1, .max = 10000});
  visit(o.step, Declaration{.name = "step",
                            .symbol = "eta",
                            .help = "step size of the mirror descent; 1 takes the weighted mean",
                            .min = 0,
                            .max = 2});
  visit(
      o.negative_ratio,
      Declaration{
          .name = "negative_ratio", .help = "weight of the repulsion from bad samples", .min = 0, .max = 10});
  visit(o.reject_samples,
        Declaration{.name = "reject_samples", .help = "draw more samples and keep those away from bad ones"});
  visit(o.inflation,
        Declaration{
            .name = "inflation", .help = "samples drawn for each one that is kept", .min = 1, .max = 100});
  visit(o.resampling,
        Declaration{.name = "resampling", .help = "how samples are selected by their probability"});
  visit(o.warm_start,
        Declaration{.name = "warm_start",
                    .help = "share of the new distribution in the initial one of the next solve",
                    .min = 0,
                    .max = 1});
  visit(o.variance_min, Declaration{.name = "variance_min",
                                    .unit = "input^2",
                                    .help = "least variance",
                                    .min = 0,
                                    .max = detail::finite});
  detail::visit_control_cost_options(o, visit);
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const ReverseMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
