#pragma once

#include "slalom/core/options.hpp"

/// Options that several methods share. What a user sets often stands in each method's own aggregate with its
/// default, what is set rarely in the groups below; what is declared of both stands here once.
namespace slalom {

/// The shape of the samples' noise. For one solver either `exponent` or `knots` may be above 0, not both, and
/// with a horizon above 2048 steps neither: otherwise `make_solver` throws std::invalid_argument. `icem` has
/// an exponent of 2 by default.
struct NoiseOptions {
  PerInput exponent = 0;           ///< beta of the noise's spectrum 1/f^beta, 0 ... 4; 0: white
  PerInput log_normal_spread = 0;  ///< sigma_ln of a log-normal factor of the noise, 0 ... 2; 0: none
  int knots = 0;  ///< along the horizon, between which the noise is interpolated, 0 ... 64; 0: none
};

/// How costs become weights.
struct WeightingOptions {
  double tsallis_index = 1;  ///< q of the weights' q-exponential; 1: exp
  /// Effective sample size, as a fraction of the samples, for which the temperature is searched in every
  /// solve; 0: the temperature is as set.
  double target_ess_fraction = 0;
};

/// Savitzky-Golay smoothing of the solution along the steps.
struct SmoothingOptions {
  int half_width = 0;  ///< steps to each side; 0: no smoothing
  int degree = 3;      ///< of the fitted polynomials
};

}  // namespace slalom

namespace slalom::detail {

/// Largest finite value of an option that has no natural bound.
inline constexpr double finite = 1e12;

/// Declares the options of sampling that the methods have in their own aggregates. A horizon above 2048 steps
/// needs uncorrelated noise (NoiseOptions).
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
    visit(o.temperature, Declaration{.name = "temperature",
                                     .symbol = "lambda",
                                     .help = "cost difference at which a weight falls by a factor of e: a "
                                             "small value selects the best sample, a large one averages",
                                     .min = 1e-6,
                                     .max = finite});
  }
  visit(o.variance, Declaration{.name = "variance",
                                .symbol = "Sigma",
                                .unit = "input^2",
                                .help = "variance of the samples",
                                .min = 0,
                                .max = finite});
  visit(o.input_min, Declaration{.name = "input_min", .unit = "input", .help = "lower bound of the inputs"});
  visit(o.input_max, Declaration{.name = "input_max", .unit = "input", .help = "upper bound of the inputs"});
  visit(
      o.zero_mean_share,
      Declaration{.name = "zero_mean_share",
                  .help = "share of the samples drawn around zero instead of the mean, without correction of "
                          "their weights",
                  .min = 0,
                  .max = 1});
  visit(o.shift_warm_start, Declaration{.name = "shift_warm_start",
                                        .help = "move the last solution forward by the elapsed time"});
}

template <class Options, class Visit>
void visit_noise_options(Options& o, Visit&& visit) {
  visit(o.exponent,
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
                    .help = "log-normal factor of the noise at the same variance, per input: 0 is none; "
                            "larger values give more distant samples",
                    .min = 0,
                    .max = 2});
  visit(o.knots, Declaration{.name = "noise_knots",
                             .symbol = "n",
                             .help = "knots along the horizon between which the noise is interpolated; 0: "
                                     "independent noise in every step",
                             .min = 0,
                             .max = 64});
}

template <class Options, class Visit>
void visit_weighting_options(Options& o, Visit&& visit) {
  visit(o.tsallis_index,
        Declaration{.name = "tsallis_index",
                    .symbol = "q",
                    .help = "weights are the q-exponential of -cost / temperature: 1 is exp; below 1, costs "
                            "above temperature / (1 - q) have weight 0; above 1, weights fall more slowly",
                    .min = -20,
                    .max = 3});
  visit(o.target_ess_fraction, Declaration{.name = "target_ess_fraction",
                                           .help = "effective sample size, as a fraction of the samples, to "
                                                   "which every solve adapts the temperature; 0: off",
                                           .min = 0,
                                           .max = 1,
                                           .formerly = "effective_share"});
}

template <class Options, class Visit>
void visit_smoothing_options(Options& o, Visit&& visit) {
  visit(o.half_width,
        Declaration{
            .name = "smoothing_half_width",
            .unit = "steps",
            .help = "Savitzky-Golay smoothing of the solution over this many steps to each side; 0: none",
            .min = 0,
            .max = 1000});
  visit(o.degree,
        Declaration{
            .name = "smoothing_degree", .help = "degree of the fitted polynomials", .min = 0, .max = 9});
}

template <class Options, class Visit>
void visit_cross_entropy_options(Options& o, Visit&& visit) {
  visit(o.iterations,
        Declaration{
            .name = "iterations", .help = "refits of the distribution in a solve", .min = 1, .max = 10000});
  visit(o.elite_share, Declaration{.name = "elite_share",
                                   .symbol = "rho",
                                   .help = "share of the samples that the distribution is refitted to",
                                   .min = 0,
                                   .max = 1});
  visit(o.smoothing, Declaration{.name = "smoothing",
                                 .help = "share of the old distribution kept in an update",
                                 .min = 0,
                                 .max = 1});
  visit(o.variance_min,
        Declaration{
            .name = "variance_min", .unit = "input^2", .help = "least variance", .min = 0, .max = finite});
  visit(o.send_best,
        Declaration{.name = "send_best", .help = "send the best sample seen instead of the mean"});
}

template <class Options, class Visit>
void visit_control_cost_options(Options& o, Visit&& visit) {
  visit(o.control_cost_discount,
        Declaration{.name = "control_cost_discount",
                    .symbol = "alpha",
                    .help = "the control term of the weights is multiplied by 1 - alpha; 1 leaves it out",
                    .min = 0,
                    .max = 1});
}

}  // namespace slalom::detail

namespace slalom {

/// Declares the options that every solver has: `std::uint64_t seed` and `int threads`. To be called in the
/// `visit_options` of a solver's options.
template <class Options, class Visit>
void visit_run_options(Options& o, Visit&& visit) {
  visit(o.seed, Declaration{.name = "seed", .help = "seed of the random numbers"});
  visit(o.threads, Declaration{.name = "threads",
                               .help = "threads that work on a solve; the result does not depend on it",
                               .min = 1,
                               .max = 1024});
}

}  // namespace slalom
