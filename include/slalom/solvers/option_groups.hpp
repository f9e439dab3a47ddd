#pragma once

#include "slalom/core/options.hpp"

/// Options that several methods share. Options that a user sets often stand in each method's own aggregate
/// with its default, the others in the groups below; both are declared here once.
namespace slalom {

/// The shape of the samples' noise. For one solver either `exponent` or `knots` may be above 0, not both, and
/// with a horizon above 2048 steps neither: otherwise `make_solver` throws std::invalid_argument.
/// `visit_noise_options` below describes the fields.
struct NoiseOptions {
  PerInput exponent = 0;
  bool pinned = false;
  int knots = 0;
};

/// The conversion of costs to weights. `visit_weighting_options` below describes the fields.
struct WeightingOptions {
  double target_ess_fraction = 0;
};

}  // namespace slalom

namespace slalom::detail {

/// Largest finite value of an option that has no natural bound.
inline constexpr double finite = 1e12;

/// Declares the options of sampling that the methods have in their own aggregates. A horizon above 2048 steps
/// needs uncorrelated noise (NoiseOptions).
template <class Options, class Visit>
void visit_sampling_options(Options& o, Visit&& visit) {
  visit(o.horizon,
        {"horizon", "steps", "inputs of a control sequence; the rollout has one state more", 1, 10000, "T"});
  visit(o.samples,
        {"samples", "", "control sequences drawn in a solve; of reverse_mppi and sv_mpc in an iteration", 1,
         4194304, "K"});
  if constexpr (requires { o.weighting; }) {
    visit(
        o.temperature,
        {"temperature", "",
         "cost difference at which a weight falls by a factor of e; 0: follows from the costs of each solve",
         0, finite, "lambda"});
  } else if constexpr (requires { o.temperature; }) {
    visit(
        o.temperature,
        {"temperature", "",
         "cost difference at which a weight falls by a factor of e; small: the best sample, large: the mean",
         1e-6, finite, "lambda"});
  }
  visit(
      o.variance,
      {"variance", "input^2",
       "variance of the samples; 0: the square of a quarter of the range between the bounds, 1 without them",
       0, finite, "Sigma"});
  visit(o.input_min, {"input_min", "input", "lower bound of the inputs"});
  visit(o.input_max, {"input_max", "input", "upper bound of the inputs"});
  visit(o.zero_mean_share,
        {"zero_mean_share", "",
         "share of the samples drawn around zero instead of the mean, with uncorrected weights", 0, 1});
  visit(o.shift_warm_start, {"shift_warm_start", "", "move the last solution forward by the elapsed time"});
}

template <class Options, class Visit>
void visit_noise_options(Options& o, Visit&& visit) {
  visit(o.exponent, {"noise_exponent", "",
                     "power 1/f^beta of the noise along the steps, per input; 0: white, 1: pink, 2: Brownian",
                     0, 4, "beta"});
  visit(o.pinned,
        {"noise_pinned", "",
         "noise with an exponent begins at 0, so that sequences continue the last input; with 4 they are "
         "smooth"});
  visit(o.knots,
        {"noise_knots", "",
         "knots along the horizon between which the noise is interpolated; 0: none, independent steps", 0, 64,
         "n"});
}

template <class Options, class Visit>
void visit_weighting_options(Options& o, Visit&& visit) {
  visit(o.target_ess_fraction, {"target_ess_fraction", "",
                                "effective sample size, as a fraction of the samples, to which the "
                                "temperature adapts; 0: 0.6 sqrt(K) / K where temperature is 0, 0.7 / "
                                "sqrt(n) for n samples of a guide",
                                0, 1});
}

template <class Options, class Visit>
void visit_cross_entropy_options(Options& o, Visit&& visit) {
  visit(o.iterations, {"iterations", "", "refits of the distribution in a solve", 1, 10000});
  visit(o.elite_share,
        {"elite_share", "", "share of the samples to which the distribution is refitted; at least one sample",
         0, 1, "rho"});
  visit(o.smoothing, {"smoothing", "", "share of the old distribution kept in an update", 0, 1});
  visit(o.variance_min, {"variance_min", "input^2", "least variance; 0: 1e-4 of variance", 0, finite});
  visit(o.send_best, {"send_best", "", "send the best sample seen instead of the mean"});
}

template <class Options, class Visit>
void visit_control_cost_options(Options& o, Visit&& visit) {
  visit(o.control_cost_discount,
        {"control_cost_discount", "",
         "the control term of the weights is multiplied by 1 - alpha; 1 leaves it out", 0, 1, "alpha"});
}

}  // namespace slalom::detail

namespace slalom {

/// Declares the options that every solver has: `std::uint64_t seed` and `int threads`. To be called in the
/// `visit_options` of a solver's options.
template <class Options, class Visit>
void visit_run_options(Options& o, Visit&& visit) {
  visit(o.seed, {"seed", "", "seed of the random numbers"});
  visit(o.threads,
        {"threads", "", "threads that work on a solve; the result does not depend on it", 1, 1024});
}

}  // namespace slalom
