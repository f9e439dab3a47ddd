#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_declarations.hpp"

namespace slalom {

/// What the weights of the guides' gradient are made of, besides the cost S of a sample v.
enum class GuideWeight {
  state_cost,  ///< S alone
  importance,  ///< and (u - n)^T Sigma^-1 v, the control term of the paper's equation (weight): u is the last
               ///< solution, n the last nominal
  proximity,   ///< and (u - v)^T Sigma^-1 (u - v), the distance to the last solution (published program)
};
inline const char* const* enum_names(GuideWeight) {
  static constexpr const char* const names[] = {"state_cost", "importance", "proximity", nullptr};
  return names;
}

/// What the Gaussian is fitted to along a guide's path.
enum class FitTarget {
  optimal_density,  ///< q* of the paper's equation (q_star): exp(-S / temperature) q(V | nominal, Sigma)
  state_cost,       ///< softmax of S with `fit_temperature` (published program)
};
inline const char* const* enum_names(FitTarget) {
  static constexpr const char* const names[] = {"optimal_density", "state_cost", nullptr};
  return names;
}

/// Options of `svg_mppi`. Defaults are the correct form of the paper (Honda et al., ICRA 2024); "published"
/// is the value, or the form, of its published program.
struct SvgMppiOptions {
  int horizon = 30;        ///< T, steps; published: 14 (15 states)
  int samples = 1024;      ///< K; published: 8000
  double temperature = 1;  ///< lambda; published: 3
  PerInput variance = 1;   ///< Sigma, input^2, where it is not adapted; published: 0.01
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int guides = 1;               ///< K_g
  int guide_iterations = 10;    ///< L
  PerInput guide_step = 0.125;  ///< epsilon, input^2; published: 0.005
  PerInput guide_variance =
      1;  ///< input^2, spread of the first guides, and Sigma of their weights; published: 0.01
  int gradient_samples = 100;                          ///< N
  PerInput gradient_variance = 0.25;                   ///< Sigma_g, input^2; published: 0.01
  double gradient_temperature = 1;                     ///< published: 3
  GuideWeight guide_weight = GuideWeight::state_cost;  ///< published: proximity
  /// Weights of a gradient are taken relative to the best sample, so that a guide whose samples are all bad
  /// moves too. Published: false, such a guide stands still.
  bool subtract_minimum = true;
  double gradient_floor = 0;  ///< added to the sum of a gradient's weights; published: 1e-10
  bool clamp_guides = true;   ///< keep guides within the bounds; published: false
  /// Every solve the best guide goes on and all others begin anew, at smooth deviations from it: they look
  /// for other modes, and it is kept until one of them is better. Published: false, all go on.
  bool restart_guides = false;
  PerInput restart_variance = 0.1;  ///< input^2, of those deviations

  bool use_nominal = true;       ///< the best guide is the nominal sequence (NS); otherwise zero is
  bool adapt_covariance = true;  ///< fit the variances to the best guide's path (AC); otherwise `variance`
  FitTarget fit_target = FitTarget::optimal_density;  ///< published: state_cost
  double fit_temperature = 0.1;                       ///< lambda of the fit to state costs
  bool fit_all_guides =
      false;  ///< pool the paths of all guides; published: true (the paper takes the best's)
  /// Take the fitted Gaussian's standard deviation for its variance. Published: true, as in the paper's
  /// equation (estimated_cov), though Sigma is a variance everywhere else.
  bool fit_standard_deviation = false;
  /// Where the fit is convex, take the curvature's absolute value. Published: true; otherwise such a fit
  /// says nothing and the variance is `variance_max`.
  bool fit_absolute_curvature = false;
  PerInput variance_min = 0.01;  ///< input^2; published: 0.001
  PerInput variance_max = 1;     ///< input^2; published: 0.1

  PerInput noise_exponent = 0;     ///< beta of the noise's spectrum 1/f^beta; 0: white
  PerInput log_normal_spread = 0;  ///< sigma_ln, log-normal factor of the noise; 0: none
  double tsallis_index = 1;        ///< q of the weights' q-exponential; 1: exp
  double effective_share = 0;      ///< effective sample size sought, a share of K; 0: `temperature` as set
  int smoothing_half_width = 0;    ///< steps to each side, of Savitzky-Golay smoothing; 0: none
  int smoothing_degree = 3;        ///< of its polynomials

  double control_cost_discount = 0;    ///< alpha; published: 0.1
  double zero_mean_share = 0;          ///< published: 0.1
  double inverse_variance_offset = 0;  ///< 1/input^2; published: 1e-4
  double normaliser_offset = 0;        ///< published: 1e-10
  bool shift_warm_start = true;        ///< published: false
  std::uint64_t seed = 0;
  int threads = 1;
};

namespace detail {

template <class Options, class Visit>
void visit_guide_options(Options& o, Visit&& visit) {
  visit(o.guides,
        Declaration{.name = "guides", .symbol = "K_g", .help = "guide particles", .min = 1, .max = 1024});
  visit(o.guide_iterations, Declaration{.name = "guide_iterations",
                                        .symbol = "L",
                                        .help = "steps the guides are moved in a solve",
                                        .min = 1,
                                        .max = 1000});
  visit(o.guide_step,
        Declaration{.name = "guide_step",
                    .symbol = "epsilon",
                    .unit = "input^2",
                    .help = "step size; a step moves a guide by epsilon / Sigma_g of the way to the "
                            "weighted mean of its samples",
                    .min = 0,
                    .max = finite});
  visit(o.guide_variance, Declaration{.name = "guide_variance",
                                      .symbol = "Sigma",
                                      .unit = "input^2",
                                      .help = "spread of the first guides, and the variance in their weights",
                                      .min = 0,
                                      .max = finite});
  visit(o.gradient_samples, Declaration{.name = "gradient_samples",
                                        .symbol = "N",
                                        .help = "samples for the gradient of a guide",
                                        .min = 1,
                                        .max = 65536});
  visit(o.gradient_variance, Declaration{.name = "gradient_variance",
                                         .symbol = "Sigma_g",
                                         .unit = "input^2",
                                         .help = "variance of the samples for the gradient",
                                         .min = 0,
                                         .max = finite});
  visit(o.gradient_temperature, Declaration{.name = "gradient_temperature",
                                            .symbol = "lambda",
                                            .help = "temperature of the weights of the gradient",
                                            .min = 1e-6,
                                            .max = finite});
  visit(o.guide_weight,
        Declaration{.name = "guide_weight", .help = "what the gradient's weights are made of"});
  visit(o.subtract_minimum,
        Declaration{.name = "subtract_minimum",
                    .help = "weights of a gradient relative to its best sample; published: false"});
  visit(o.gradient_floor, Declaration{.name = "gradient_floor",
                                      .help = "added to the sum of a gradient's weights; published: 1e-10",
                                      .min = 0,
                                      .max = 1});
  visit(o.clamp_guides,
        Declaration{.name = "clamp_guides", .help = "keep guides within the bounds; published: false"});
  visit(
      o.restart_guides,
      Declaration{.name = "restart_guides",
                  .help = "all guides but the best begin anew in every solve, at smooth deviations from it"});
  visit(o.restart_variance, Declaration{.name = "restart_variance",
                                        .unit = "input^2",
                                        .help = "of the deviations at which guides begin anew",
                                        .min = 0,
                                        .max = finite});
}

template <class Options, class Visit>
void visit_fit_options(Options& o, Visit&& visit) {
  visit(o.use_nominal, Declaration{.name = "use_nominal", .help = "the best guide is the nominal sequence"});
  visit(o.adapt_covariance,
        Declaration{.name = "adapt_covariance", .help = "fit the variances to the path of the best guide"});
  visit(o.fit_target,
        Declaration{.name = "fit_target", .symbol = "q*", .help = "what the Gaussian is fitted to"});
  visit(o.fit_temperature, Declaration{.name = "fit_temperature",
                                       .symbol = "lambda",
                                       .help = "temperature of the fit to state costs",
                                       .min = 1e-6,
                                       .max = finite});
  visit(o.fit_all_guides, Declaration{.name = "fit_all_guides",
                                      .help = "fit to the paths of all guides together; published: true"});
  visit(o.fit_standard_deviation,
        Declaration{.name = "fit_standard_deviation",
                    .help = "take the fitted standard deviation for the variance; published: true"});
  visit(o.fit_absolute_curvature,
        Declaration{.name = "fit_absolute_curvature",
                    .help = "take convex fits for concave ones of the same curvature; published: true"});
  visit(o.variance_min, Declaration{.name = "variance_min",
                                    .unit = "input^2",
                                    .help = "least adapted variance",
                                    .min = 0,
                                    .max = finite});
  visit(o.variance_max, Declaration{.name = "variance_max",
                                    .unit = "input^2",
                                    .help = "largest adapted variance",
                                    .min = 0,
                                    .max = finite});
}

}  // namespace detail

template <class Options, class Visit>
requires is_options_of<Options, SvgMppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_guide_options(o, visit);
  detail::visit_fit_options(o, visit);
  detail::visit_noise_options(o, visit);
  detail::visit_weight_options(o, visit);
  detail::visit_smoothing_options(o, visit);
  detail::visit_control_cost_options(o, visit);
  detail::visit_run_options(o, visit);
}

}  // namespace slalom
