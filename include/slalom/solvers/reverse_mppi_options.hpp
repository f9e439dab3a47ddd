#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_declarations.hpp"

namespace slalom {

/// With which densities samples are rejected.
enum class RejectionModel {
  normal,     ///< a sample is kept with probability p / (p + p_rejected), normal densities at the sample
  published,  ///< product over steps of 1 / (p + p_rejected) where a "density" grows with the distance, and p
              ///< is taken at the rejected mean (published program)
};
inline const char* const* enum_names(RejectionModel) {
  static constexpr const char* const names[] = {"normal", "published", nullptr};
  return names;
}

/// How samples are picked by their probability.
enum class Resampling {
  systematic,   ///< at even distances along the sum of probabilities: as often as it is due, up to rounding
  multinomial,  ///< independently, with replacement (published program)
};
inline const char* const* enum_names(Resampling) {
  static constexpr const char* const names[] = {"systematic", "multinomial", nullptr};
  return names;
}

/// Options of `reverse_mppi`. Defaults are the correct form of the method (Kobayashi and Fukumoto 2022);
/// "published" is the value, or the form, of the published program of Honda et al. (ICRA 2024).
struct ReverseMppiOptions {
  int horizon = 30;        ///< T, steps; published: 14 (15 states)
  int samples = 256;       ///< K, evaluated in each iteration; published: 200
  double temperature = 1;  ///< lambda; published: 3
  PerInput variance = 1;   ///< Sigma at the start, input^2; published: 0.1
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();

  int iterations = 20;          ///< published: 50
  double step = 0.2;            ///< eta of the mirror descent; published: 0.05
  double negative_ratio = 0.5;  ///< weight of the repulsion from bad samples; published: 1
  bool reject_samples = true;
  double inflation = 2;                               ///< samples drawn for each one that is kept
  RejectionModel rejection = RejectionModel::normal;  ///< published: published
  Resampling resampling = Resampling::systematic;     ///< published: multinomial
  /// Measure second moments in units of the present variance, but use them as variances all the same.
  /// Published: true, so that every variance is drawn towards 1.
  bool dimensionless_variance = false;
  double warm_start = 0.5;       ///< share of the new distribution in the start of the next solve
  PerInput variance_min = 1e-4;  ///< input^2; published: 0, nothing keeps a variance from vanishing

  double control_cost_discount = 0;    ///< alpha; published: 0.1
  double zero_mean_share = 0;          ///< published: 0.1
  double inverse_variance_offset = 0;  ///< 1/input^2; published: 1e-4
  double normaliser_offset = 0;        ///< published: 1e-10
  bool shift_warm_start = true;        ///< published: false
  std::uint64_t seed = 0;
  int threads = 1;
};

template <class Options, class Visit>
requires is_options_of<Options, ReverseMppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  visit(o.iterations,
        Declaration{
            .name = "iterations", .help = "updates of the distribution in a solve", .min = 1, .max = 10000});
  visit(o.step, Declaration{.name = "step",
                            .symbol = "eta",
                            .help = "step of the mirror descent: 1 takes the weighted mean",
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
  visit(o.rejection, Declaration{.name = "rejection", .help = "densities by which samples are rejected"});
  visit(o.resampling,
        Declaration{.name = "resampling", .help = "how samples are picked by their probability"});
  visit(o.dimensionless_variance,
        Declaration{.name = "dimensionless_variance",
                    .help = "measure new variances in units of the old; published: true"});
  visit(o.warm_start, Declaration{.name = "warm_start",
                                  .help = "share of the new distribution in the start of the next solve",
                                  .min = 0,
                                  .max = 1});
  visit(o.variance_min, Declaration{.name = "variance_min",
                                    .unit = "input^2",
                                    .help = "least variance",
                                    .min = 0,
                                    .max = detail::finite});
  detail::visit_control_cost_options(o, visit);
  detail::visit_run_options(o, visit);
}

}  // namespace slalom
