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

/// The shape of the samples' noise.
template <class Options, class Visit>
void visit_noise_options(Options& o, Visit&& visit) {
  visit(o.noise_exponent,
        Declaration{.name = "noise_exponent",
                    .symbol = "beta",
                    .help =
                        "colour of the noise along the steps, power 1/f^beta, per input: 0 is white, 1 pink, "
                        "2 Brownian; the larger, the smoother",
                    .min = 0,
                    .max = 4});
  visit(o.log_normal_spread,
        Declaration{.name = "log_normal_spread",
                    .symbol = "sigma_ln",
                    .help = "log-normal factor of the noise at the same variance, per input: 0 is none; the "
                            "larger, the more samples far away",
                    .min = 0,
                    .max = 2});
}

/// How costs become weights.
template <class Options, class Visit>
void visit_weight_options(Options& o, Visit&& visit) {
  visit(o.tsallis_index,
        Declaration{.name = "tsallis_index",
                    .symbol = "q",
                    .help =
                        "weights are the q-exponential of -cost / temperature: 1 is exp; below 1 costs above "
                        "temperature / (1 - q) count nothing, above 1 tails are heavy",
                    .min = -20,
                    .max = 3});
  visit(o.effective_share,
        Declaration{
            .name = "effective_share",
            .help = "effective sample size as a share of the samples, for which the temperature is sought "
                    "in every solve; 0: the temperature is as set",
            .min = 0,
            .max = 1});
}

/// Smoothing of the solution along the steps.
template <class Options, class Visit>
void visit_smoothing_options(Options& o, Visit&& visit) {
  visit(o.smoothing_half_width,
        Declaration{
            .name = "smoothing_half_width",
            .unit = "steps",
            .help = "Savitzky-Golay smoothing of the solution over this many steps to each side; 0: none",
            .min = 0,
            .max = 1000});
  visit(o.smoothing_degree,
        Declaration{
            .name = "smoothing_degree", .help = "degree of the polynomials that smooth", .min = 0, .max = 9});
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
