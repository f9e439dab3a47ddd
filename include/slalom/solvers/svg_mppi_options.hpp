#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_groups.hpp"
#include "slalom/solvers/prediction_errors.hpp"
#include "slalom/solvers/published/published_options.hpp"
#include "slalom/solvers/solver.hpp"

namespace slalom {

/// The cost by which a gradient of the guides weighs its samples. S is the cost of a sample v, u the last
/// solution, n the last nominal sequence.
enum class GuideWeight {
  state_cost,  ///< S alone
  importance,  ///< S and (u - n)^T Sigma^-1 v, the control term of the paper's equation (8)
  proximity,   ///< S and (u - v)^T Sigma^-1 (u - v), the distance to the last solution
};
inline const char* const* enum_names(GuideWeight) {
  static constexpr const char* const names[] = {"state_cost", "importance", "proximity", nullptr};
  return names;
}

/// The sequence around which `svg_mppi` draws its samples. docs/algorithms/svg-mppi.md derives both forms.
enum class SampleCentre {
  /// The nominal sequence: the weights need no control term. The last solution joins the guides.
  nominal,
  /// The last solution, as in the paper: the weights correct for the distance to the nominal sequence.
  solution,
};
inline const char* const* enum_names(SampleCentre) {
  static constexpr const char* const names[] = {"nominal", "solution", nullptr};
  return names;
}

/// The guide particles of `svg_mppi`, which follow a gradient to a mode.
/// `visit_guide_options` below describes the fields.
struct GuideOptions {
  int count = 2;
  int iterations = 1;
  PerInput step = 0;
  PerInput variance = 0;
  int gradient_samples = 3;
  PerInput gradient_variance = 0;
  double gradient_temperature = 0;
  GuideWeight weight = GuideWeight::state_cost;
  /// Restarted guides search for other modes; the best guide is kept until another is better.
  bool restart = true;
  PerInput restart_variance = 0;
  /// If `use_nominal` is false, samples are always drawn around the last solution.
  SampleCentre sample_around = SampleCentre::nominal;
};

/// Options of `svg_mppi`: Stein variational guided MPPI (Honda et al., ICRA 2024). Equation numbers are those
/// of the paper. `visit_options` below describes the fields.
struct SvgMppiOptions {
  static constexpr const char* method = "svg_mppi";  ///< name in configurations

  int horizon = 30;
  int samples = 1024;
  int batches = 0;
  int nearby_states = 16;
  double temperature = 0;
  PerInput variance = 0;  ///< variance of the samples if it is not adapted
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  GuideOptions guides{};  ///< the guide particles
  bool use_nominal = true;
  bool adapt_covariance = true;
  PerInput variance_min = 0;
  PerInput variance_max = 0;

  /// Shape of the noise; coloured and normal. In several batches, a part of the samples has white noise
  /// unless it is pinned or has knots.
  NoiseOptions noise{.exponent = 3};
  WeightingOptions weighting{};  ///< how costs become weights
  double control_cost_discount = 0;
  double zero_mean_share = 0;
  bool shift_warm_start = true;  ///< the guides are shifted, too
  std::uint64_t seed = 0;
  int threads = 1;
  PublishedSvgMppi published{};  ///< only to reproduce the program of proj-svg_mppi
};

namespace detail {

template <class Options, class Visit>
void visit_guide_options(Options& o, Visit&& visit) {
  visit(o.count, {"guides", "",
                  "guides that look for other ways. In several batches at most one for each 100 samples, and "
                  "at most 2; 0: "
                  "the samples stay around the plan",
                  0, 1024, "K_g"});
  visit(o.iterations,
        {"guide_iterations", "", "number of steps by which the guides move in a solve", 1, 1000, "L"});
  visit(o.step,
        {"guide_step", "input^2",
         "step size: a step moves a guide by epsilon / Sigma_g of the way to its samples' weighted mean; 0: "
         "half of gradient_variance",
         0, finite, "epsilon"});
  visit(o.variance, {"guide_variance", "input^2",
                     "variance of the initial guides, and the variance in their weights; 0: half of variance",
                     0, finite, "Sigma"});
  visit(o.gradient_samples, {"gradient_samples", "", "samples for the gradient of a guide", 1, 65536, "N"});
  visit(o.gradient_variance,
        {"gradient_variance", "input^2", "variance of the samples for the gradient; 0: half of variance", 0,
         finite, "Sigma_g"});
  visit(o.gradient_temperature,
        {"gradient_temperature", "",
         "temperature of the weights of the gradient; 0: follows from the costs of its samples", 0, finite,
         "lambda"});
  visit(o.weight, {"guide_weight", "", "how the weights of the gradient are computed"});
  visit(o.restart, {"restart_guides", "",
                    "all guides but the best restart in every solve, at smooth deviations from the best"});
  visit(o.restart_variance, {"restart_variance", "input^2",
                             "variance of the deviations at which guides restart; 0: variance", 0, finite});
  visit(o.sample_around, {"sample_around", "",
                          "mean of the samples: the nominal sequence, or the last solution as in the paper"});
}

template <class Options, class Visit>
void visit_variance_options(Options& o, Visit&& visit) {
  visit(o.use_nominal, {"use_nominal", "", "use the best guide as the nominal sequence (NS), equation (12)"});
  visit(o.adapt_covariance,
        {"adapt_covariance", "",
         "fit the variances to a path of 3 or more steps of the best guide (AC), equation (13)"});
  visit(o.variance_min,
        {"variance_min", "input^2", "least adapted variance; 0: a quarter of variance", 0, finite});
  visit(o.variance_max, {"variance_max", "input^2",
                         "largest adapted variance; variance_min where it is less; 0: variance", 0, finite});
}

}  // namespace detail

template <class Options, class Visit>
requires is_options_of<Options, SvgMppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(o.batches,
        {"batches", "",
         "parts of the samples, each drawn around the means of the last; 1: the paper's closed form; 0: "
         "0.75 cbrt(K), at most 8. Always 1 with samples around the solution",
         0, 1000});
  visit(o.nearby_states,
        {"nearby_states", "",
         "in several batches, most states near the present one from which the last sequences are evaluated: "
         "as far from it as the last predictions were wrong, in each direction and its opposite",
         0, 2 * PredictionErrors::kept});
  detail::visit_guide_options(o.guides, visit);
  detail::visit_variance_options(o, visit);
  detail::visit_noise_options(o.noise, visit);
  detail::visit_weighting_options(o.weighting, visit);
  detail::visit_control_cost_options(o, visit);
  visit_run_options(o, visit);
  visit_options(o.published, visit);
}

/// A solver with these options, see registry.hpp.
std::unique_ptr<Solver> make_solver(const SvgMppiOptions& options, int inputs,
                                    std::shared_ptr<ThreadPool> pool = nullptr);

}  // namespace slalom
