#include "slalom/solvers/published/published_solvers.hpp"

#include <stdexcept>
#include <string>

namespace slalom {

MppiOptions published_mppi() {
  return {.horizon = 14,
          .samples = 10000,
          .temperature = 3,
          .variance = 0.1,
          .input_min = -0.45,
          .input_max = 0.45,
          .control_cost_discount = 0.1,
          .zero_mean_share = 0.1,
          .shift_warm_start = false,
          .published = {.inverse_variance_offset = 1e-4, .normaliser_offset = 1e-10}};
}

SvgMppiOptions published_svg_mppi() {
  return {.horizon = 14,
          .samples = 8000,
          .temperature = 3,
          .variance = 0.01,
          .input_min = -0.45,
          .input_max = 0.45,
          .guides = {.count = 1,
                     .iterations = 10,
                     .step = 0.005,
                     .variance = 0.01,
                     .gradient_samples = 100,
                     .gradient_variance = 0.01,
                     .gradient_temperature = 3,
                     .weight = GuideWeight::proximity,
                     .restart = false,
                     .sample_around = SampleCentre::solution},
          .use_nominal = true,
          .adapt_covariance = true,
          .variance_min = 0.001,
          .variance_max = 0.1,
          .control_cost_discount = 0.1,
          .zero_mean_share = 0.1,
          .shift_warm_start = false,
          .published = {.inverse_variance_offset = 1e-4,
                        .normaliser_offset = 1e-10,
                        .subtract_minimum = false,
                        .gradient_floor = 1e-10,
                        .clamp_guides = false,
                        .fit_target = FitTarget::state_cost,
                        .fit_temperature = 0.1,
                        .fit_all_guides = true,
                        .fit_standard_deviation = true,
                        .fit_absolute_curvature = true}};
}

ReverseMppiOptions published_reverse_mppi() {
  return {.horizon = 14,
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
          .resampling = Resampling::multinomial,
          .warm_start = 0.5,
          .variance_min = 0,
          .control_cost_discount = 0.1,
          .zero_mean_share = 0.1,
          .shift_warm_start = false,
          .published = {.inverse_variance_offset = 1e-4,
                        .normaliser_offset = 1e-10,
                        .rejection = RejectionModel::published,
                        .dimensionless_variance = true}};
}

SvMpcOptions published_sv_mpc() {
  return {.horizon = 14,
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
          .best_particle = false,
          .variance_min = 0,
          .control_cost_discount = 0.1,
          .zero_mean_share = 0.1,
          .shift_warm_start = false,
          .published = {.inverse_variance_offset = 1e-4,
                        .normaliser_offset = 1e-10,
                        .gradient_control_term = true,
                        .bandwidth = BandwidthModel::squared_norms,
                        .inverted_prior = true,
                        .subtract_minimum = false,
                        .gradient_floor = 1e-10,
                        .clamp_particles = false,
                        .clamp_solution = false,
                        .dimensionless_variance = true}};
}

CemOptions published_cem() {
  return {.horizon = 14,
          .samples = 1000,
          .variance = 0.1,
          .input_min = -0.45,
          .input_max = 0.45,
          .iterations = 5,
          .elite_share = 0.1,
          .shift_warm_start = false};
}

SolverOptions published_solver_options(std::string_view method) {
  if (method == MppiOptions::method) return published_mppi();
  if (method == SvgMppiOptions::method) return published_svg_mppi();
  if (method == ReverseMppiOptions::method) return published_reverse_mppi();
  if (method == SvMpcOptions::method) return published_sv_mpc();
  if (method == CemOptions::method) return published_cem();
  throw std::invalid_argument("method: '" + std::string(method) +
                              "' must be a method of the paper's program");
}

}  // namespace slalom
