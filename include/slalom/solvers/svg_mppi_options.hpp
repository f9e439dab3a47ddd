#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// The costs in the weights of the guides' gradient; S is the cost of a sample v, u the last solution, n the
/// last nominal sequence.
enum class GuideWeight {
  state_cost,  ///< S alone
  importance,  ///< S and (u - n)^T Sigma^-1 v, the control term of the paper's equation (8)
  proximity,   ///< S and (u - v)^T Sigma^-1 (u - v), the distance to the last solution
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(GuideWeight) {
  static constexpr const char* const names[] = {"state_cost", "importance", "proximity", nullptr};
  return names;
}

/// The gradient that the guides of `svg_mppi` follow.
enum class GuideGradient {
  surrogate,  ///< the surrogate gradient of samples, equation (11)
  exact,      ///< the derivative of the cost, of an evaluator that has it (`GradientEvaluator`)
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(GuideGradient) {
  static constexpr const char* const names[] = {"surrogate", "exact", nullptr};
  return names;
}

/// The sequence around which `svg_mppi` draws its samples. docs/algorithms/svg-mppi.md derives both forms.
enum class SampleCentre {
  /// The nominal sequence: the weights need no control term. The last solution joins the guides.
  nominal,
  /// The last solution, as in the paper: the weights correct for the distance to the nominal sequence.
  solution,
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(SampleCentre) {
  static constexpr const char* const names[] = {"nominal", "solution", nullptr};
  return names;
}

/// The guide particles of `svg_mppi`, which follow a gradient to a mode.
struct GuideOptions {
  int count = 4;                      ///< K_g
  int iterations = 10;                ///< L, number of steps by which the guides move in a solve
  PerInput step = 0.125;              ///< epsilon, input^2
  PerInput variance = 1;              ///< input^2, of the initial guides, and Sigma of their weights
  int gradient_samples = 25;          ///< N, for the gradient of a guide
  PerInput gradient_variance = 0.25;  ///< Sigma_g, input^2
  double gradient_temperature = 1;    ///< lambda of the weights of the gradient
  GuideWeight weight = GuideWeight::state_cost;  ///< how the weights of the gradient are computed
  /// In every solve all guides but the best restart at smooth deviations from the best one: they search for
  /// other modes, and the best is kept until another is better. Otherwise all guides continue.
  bool restart = true;
  PerInput restart_variance = 1;  ///< input^2, of those deviations
  /// Mean of the samples. Without the nominal sequence (`use_nominal`) it is the last solution.
  SampleCentre sample_around = SampleCentre::nominal;
  /// With `exact`, the weights of the gradient (`weight`) must be those of the costs alone, a step is limited
  /// by `gradient_variance`, and `gradient_samples` and `zero_mean_share` do not count for guides.
  GuideGradient gradient = GuideGradient::surrogate;
};

/// Options of `svg_mppi`: Stein variational guided MPPI (Honda et al., ICRA 2024), whose equations are cited
/// here.
struct SvgMppiOptions {
  static constexpr const char* method = "svg_mppi";  ///< name in configurations

  int horizon = 30;                                               ///< T, steps
  int samples = 1024;                                             ///< K, control sequences drawn in a solve
  double temperature = 1;                                         ///< lambda
  PerInput variance = 1;                                          ///< Sigma, input^2, where it is not adapted
  PerInput input_min = -std::numeric_limits<double>::infinity();  ///< lower bounds of the inputs
  PerInput input_max = std::numeric_limits<double>::infinity();   ///< upper bounds of the inputs

  GuideOptions guides{};  ///< the guide particles
  bool use_nominal =
      true;  ///< use the best guide as the nominal sequence (NS), equation (12); otherwise zero is
  bool adapt_covariance = true;  ///< fit the variances to the best guide's path (AC), equation (13)
  PerInput variance_min = 0.01;  ///< least adapted variance, input^2
  PerInput variance_max = 1;     ///< largest adapted variance, input^2; variance_min where it is less

  NoiseOptions noise{};              ///< shape of the noise; white and normal
  WeightingOptions weighting{};      ///< how costs become weights; exponentially
  SmoothingOptions smoothing{};      ///< of the solution; none
  double control_cost_discount = 0;  ///< alpha: the control term is multiplied by 1 - alpha
  double zero_mean_share = 0;        ///< of the samples, drawn around zero instead of the last solution
  bool shift_warm_start = true;      ///< move guides and last solution forward by the elapsed time
  std::uint64_t seed = 0;            ///< seed of the random numbers
  int threads = 1;                   ///< threads that work on a solve; the result does not depend on it
  PublishedSvgMppi published{};      ///< only to reproduce the program of proj-svg_mppi
};

namespace detail {

template <class Options, class Visit>
void visit_guide_options(Options& o, Visit&& visit) {
  visit(o.count,
        Declaration{.name = "guides", .symbol = "K_g", .help = "guide particles", .min = 1, .max = 1024});
  visit(o.iterations, Declaration{.name = "guide_iterations",
                                  .symbol = "L",
                                  .help = "number of steps by which the guides move in a solve",
                                  .min = 1,
                                  .max = 1000});
  visit(o.step, Declaration{.name = "guide_step",
                            .symbol = "epsilon",
                            .unit = "input^2",
                            .help = "step size; a step moves a guide by epsilon / Sigma_g of the way to the "
                                    "weighted mean of its samples",
                            .min = 0,
                            .max = finite});
  visit(o.variance, Declaration{.name = "guide_variance",
                                .symbol = "Sigma",
                                .unit = "input^2",
                                .help = "variance of the initial guides, and the variance in their weights",
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
  visit(o.weight,
        Declaration{.name = "guide_weight", .help = "how the weights of the gradient are computed"});
  visit(
      o.restart,
      Declaration{
          .name = "restart_guides",
          .help = "all guides but the best restart in every solve, at smooth deviations from the best one"});
  visit(o.restart_variance, Declaration{.name = "restart_variance",
                                        .unit = "input^2",
                                        .help = "variance of the deviations at which guides restart",
                                        .min = 0,
                                        .max = finite});
  visit(
      o.sample_around,
      Declaration{.name = "sample_around",
                  .help = "mean of the samples: the nominal sequence, or the last solution as in the paper"});
  visit(o.gradient, Declaration{.name = "guide_gradient",
                                .help = "gradient for the guides: estimated from samples, or exact if the "
                                        "problem has derivatives"});
}

template <class Options, class Visit>
void visit_variance_options(Options& o, Visit&& visit) {
  visit(o.use_nominal,
        Declaration{.name = "use_nominal", .help = "use the best guide as the nominal sequence"});
  visit(o.adapt_covariance,
        Declaration{.name = "adapt_covariance", .help = "fit the variances to the path of the best guide"});
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

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, SvgMppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_guide_options(o.guides, visit);
  detail::visit_variance_options(o, visit);
  detail::visit_noise_options(o.noise, visit);
  detail::visit_weighting_options(o.weighting, visit);
  detail::visit_smoothing_options(o.smoothing, visit);
  detail::visit_control_cost_options(o, visit);
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const SvgMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
