#pragma once

#include <cstdint>
#include <limits>

#include "slalom/solvers/option_declarations.hpp"

namespace slalom {

/// Options of `mppi`. Defaults are the method as Williams et al. (2018) have it; what "published" says of an
/// option is its value in the published program of Honda et al. (ICRA 2024).
struct MppiOptions {
  int horizon = 30;        ///< T, steps; published: 14 (15 states)
  int samples = 1024;      ///< K; published: 10000
  double temperature = 1;  ///< lambda; published: 3
  PerInput variance = 1;   ///< Sigma, input^2; published: 0.1
  PerInput input_min = -std::numeric_limits<double>::infinity();
  PerInput input_max = std::numeric_limits<double>::infinity();
  PerInput noise_exponent = 0;       ///< beta of the noise's spectrum 1/f^beta; 0: white
  PerInput log_normal_spread = 0;    ///< sigma_ln, log-normal factor of the noise; 0: none
  double tsallis_index = 1;          ///< q of the weights' q-exponential; 1: exp
  double effective_share = 0;        ///< effective sample size sought, a share of K; 0: `temperature` as set
  int smoothing_half_width = 0;      ///< steps to each side, of Savitzky-Golay smoothing; 0: none
  int smoothing_degree = 3;          ///< of its polynomials
  double control_cost_discount = 0;  ///< alpha; published: 0.1
  double zero_mean_share = 0;        ///< published: 0.1
  double inverse_variance_offset = 0;  ///< 1/input^2; published: 1e-4
  double normaliser_offset = 0;        ///< published: 1e-10
  bool shift_warm_start = true;        ///< published: false
  std::uint64_t seed = 0;
  int threads = 1;
};

template <class Options, class Visit>
requires is_options_of<Options, MppiOptions>
void visit_options(Options& o, Visit&& visit) {
  detail::visit_sampling_options(o, visit);
  detail::visit_noise_options(o, visit);
  detail::visit_weight_options(o, visit);
  detail::visit_smoothing_options(o, visit);
  detail::visit_control_cost_options(o, visit);
  detail::visit_run_options(o, visit);
}

}  // namespace slalom
