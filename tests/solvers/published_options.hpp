#pragma once

#include <string_view>

#include "slalom/solvers/make_solver.hpp"

namespace slalom::testing {

/// The options of the published program: the forms that depart from the paper and its parameters.
inline SolverOptions published_options(std::string_view name) {
  if (name == "svg_mppi") {
    return SvgMppiOptions{.horizon = 14,
                          .samples = 8000,
                          .temperature = 3,
                          .variance = 0.01,
                          .input_min = -0.45,
                          .input_max = 0.45,
                          .guides = 1,
                          .guide_iterations = 10,
                          .guide_step = 0.005,
                          .guide_variance = 0.01,
                          .gradient_samples = 100,
                          .gradient_variance = 0.01,
                          .gradient_temperature = 3,
                          .guide_weight = GuideWeight::proximity,
                          .subtract_minimum = false,
                          .gradient_floor = 1e-10,
                          .clamp_guides = false,
                          .use_nominal = true,
                          .adapt_covariance = true,
                          .fit_target = FitTarget::state_cost,
                          .fit_temperature = 0.1,
                          .fit_all_guides = true,
                          .fit_standard_deviation = true,
                          .fit_absolute_curvature = true,
                          .variance_min = 0.001,
                          .variance_max = 0.1,
                          .control_cost_discount = 0.1,
                          .zero_mean_share = 0.1,
                          .inverse_variance_offset = 1e-4,
                          .normaliser_offset = 1e-10,
                          .shift_warm_start = false};
  }
  if (name == "reverse_mppi") {
    return ReverseMppiOptions{.horizon = 14,
                              .samples = 200,
                              .temperature = 3,
                              .variance = 0.1,
                              .input_min = -0.45,
                              .input_max = 0.45,
                              .iterations = 50,
                              .step = 0.05,
                              .negative_ratio = 1,
                              .reject_samples = true,
                              .inflation = 2,
                              .rejection = RejectionModel::published,
                              .resampling = Resampling::multinomial,
                              .dimensionless_variance = true,
                              .warm_start = 0.5,
                              .variance_min = 0,
                              .control_cost_discount = 0.1,
                              .zero_mean_share = 0.1,
                              .inverse_variance_offset = 1e-4,
                              .normaliser_offset = 1e-10,
                              .shift_warm_start = false};
  }
  if (name == "sv_mpc") {
    return SvMpcOptions{.horizon = 14,
                        .samples = 500,
                        .temperature = 3,
                        .variance = 0.1,
                        .input_min = -0.45,
                        .input_max = 0.45,
                        .iterations = 3,
                        .step = 0.5,
                        .limit_step = false,
                        .gradient_samples = 10,
                        .gradient_variance = 0.01,
                        .gradient_control_term = true,
                        .best_particle = false,
                        .bandwidth = BandwidthModel::squared_norms,
                        .inverted_prior = true,
                        .subtract_minimum = false,
                        .gradient_floor = 1e-10,
                        .clamp_particles = false,
                        .dimensionless_variance = true,
                        .variance_min = 0,
                        .control_cost_discount = 0.1,
                        .zero_mean_share = 0.1,
                        .inverse_variance_offset = 1e-4,
                        .normaliser_offset = 1e-10,
                        .shift_warm_start = false};
  }
  if (name == "cem") {
    return CemOptions{.horizon = 14,
                      .samples = 1000,
                      .variance = 0.1,
                      .input_min = -0.45,
                      .input_max = 0.45,
                      .iterations = 5,
                      .elite_share = 0.1,
                      .shift_warm_start = false};
  }
  return MppiOptions{.horizon = 14,
                     .samples = 10000,
                     .temperature = 3,
                     .variance = 0.1,
                     .input_min = -0.45,
                     .input_max = 0.45,
                     .control_cost_discount = 0.1,
                     .zero_mean_share = 0.1,
                     .inverse_variance_offset = 1e-4,
                     .normaliser_offset = 1e-10,
                     .shift_warm_start = false};
}

/// Whether an option set departs from its method so far that it misses the optimum of a linear-quadratic
/// problem: the published reverse_mppi and sv_mpc draw every variance towards 1, sv_mpc away from its prior.
inline bool published_departs(std::string_view set) {
  return set == "reverse_mppi_published" || set == "sv_mpc_published";
}

}  // namespace slalom::testing
