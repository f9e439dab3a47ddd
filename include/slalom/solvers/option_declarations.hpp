#pragma once

#include "slalom/core/options.hpp"

/// Declarations of the options that several methods share: the fields stand in each method's own aggregate
/// with their defaults, what is said of them stands here once.
namespace slalom::detail {

/// Largest finite value of an option that has no natural bound.
inline constexpr double finite = 1e12;

template <class Options, class Visit>
void visit_sampling_options(Options& o, Visit&& visit) {
  visit(o.horizon, Declaration{.name = "horizon",
                               .symbol = "T",
                               .unit = "steps",
                               .help = "inputs of a control sequence; the rollout has one state more",
                               .min = 1,
                               .max = 10000});
  visit(o.samples, Declaration{.name = "samples",
                               .symbol = "K",
                               .help = "control sequences drawn in a solve",
                               .min = 1,
                               .max = 4194304});
  if constexpr (requires { o.temperature; }) {
    visit(o.temperature,
          Declaration{
              .name = "temperature",
              .symbol = "lambda",
              .help = "cost difference at which a weight falls by e: small picks the best, large averages",
              .min = 1e-6,
              .max = finite});
  }
  visit(o.variance, Declaration{.name = "variance",
                                .symbol = "Sigma",
                                .unit = "input^2",
                                .help = "variance of the samples, per input",
                                .min = 0,
                                .max = finite});
  visit(o.input_min, Declaration{.name = "input_min", .unit = "input", .help = "lower bound, per input"});
  visit(o.input_max, Declaration{.name = "input_max", .unit = "input", .help = "upper bound, per input"});
  visit(
      o.zero_mean_share,
      Declaration{.name = "zero_mean_share",
                  .help = "share of the samples drawn around zero instead of the mean, without correction of "
                          "their weights; published: 0.1",
                  .min = 0,
                  .max = 1});
  visit(o.shift_warm_start,
        Declaration{.name = "shift_warm_start",
                    .help = "move the last solution forward by the elapsed time; published: false"});
}

template <class Options, class Visit>
void visit_control_cost_options(Options& o, Visit&& visit) {
  visit(o.control_cost_discount,
        Declaration{.name = "control_cost_discount",
                    .symbol = "alpha",
                    .help = "the control term of the weights is multiplied by 1 - alpha; published: 0.1, the "
                            "paper has no such factor",
                    .min = 0,
                    .max = 1});
  visit(o.inverse_variance_offset,
        Declaration{.name = "inverse_variance_offset",
                    .unit = "1/input^2",
                    .help = "added to the inverse of every variance; published: 1e-4",
                    .min = 0,
                    .max = finite});
  visit(
      o.normaliser_offset,
      Declaration{.name = "normaliser_offset",
                  .help = "added to the sum of weights before dividing by it, so that they sum to less than "
                          "1; published: 1e-10",
                  .min = 0,
                  .max = 1});
}

template <class Options, class Visit>
void visit_run_options(Options& o, Visit&& visit) {
  visit(o.seed, Declaration{.name = "seed", .help = "of the random numbers"});
  visit(o.threads, Declaration{.name = "threads",
                               .help = "that work on a solve; the result does not depend on it",
                               .min = 1,
                               .max = 1024});
}

}  // namespace slalom::detail
