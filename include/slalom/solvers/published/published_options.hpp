#pragma once

#include "slalom/core/options.hpp"

/// Reproduction of the published program of Honda et al. (ICRA 2024). This folder holds the options that
/// exist only for it: each of the methods' aggregates has one of the aggregates below as its member
/// `published`. Their defaults are the methods as the papers have them; `published_solvers.hpp` makes the
/// options of the program. docs/algorithms/published-program.md lists every departure of the program from the
/// paper.
namespace slalom {

/// Of `mppi`.
struct PublishedMppi {
  double inverse_variance_offset = 0;  ///< added to the inverse of every variance, 1/input^2; program: 1e-4
  double normaliser_offset = 0;        ///< added to the sum of the weights; program: 1e-10
};

/// What the Gaussian is fitted to along a guide's path.
enum class FitTarget {
  optimal_density,  ///< q* of the paper's equation (5): exp(-S / temperature) q(V | nominal, Sigma)
  state_cost,       ///< softmax of S with `fit_temperature` (program)
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(FitTarget) {
  static constexpr const char* const names[] = {"optimal_density", "state_cost", nullptr};
  return names;
}

/// Of `svg_mppi`.
struct PublishedSvgMppi {
  double inverse_variance_offset = 0;  ///< as in `PublishedMppi`
  double normaliser_offset = 0;        ///< as in `PublishedMppi`
  /// Weights of a gradient are taken relative to the best sample, so that a guide whose samples are all bad
  /// moves too. Program: false, such a guide stands still.
  bool subtract_minimum = true;
  double gradient_floor = 0;  ///< added to the sum of a gradient's weights; program: 1e-10
  bool clamp_guides = true;   ///< keep guides within the bounds; program: false
  FitTarget fit_target = FitTarget::optimal_density;  ///< program: state_cost
  double fit_temperature = 0.1;                       ///< lambda of the fit to state costs
  bool fit_all_guides = false;                        ///< pool the paths of all guides; program: true
  /// Take the fitted Gaussian's standard deviation for its variance. Program: true, as the paper's equation
  /// (13) can be read, though Sigma is a variance everywhere else.
  bool fit_standard_deviation = false;
  /// Where the fit is convex, take the curvature's absolute value, and solve its normal equations as they are.
  /// Program: true; otherwise such a fit determines nothing and the variance is `variance_max`.
  bool fit_absolute_curvature = false;
};

/// By which densities `reverse_mppi` rejects samples.
enum class RejectionModel {
  normal,     ///< a sample is kept with probability p / (p + p_rejected), normal densities at the sample
  published,  ///< product over steps of 1 / (p + p_rejected) where a "density" grows with the distance, and p
              ///< is taken at the rejected mean (program)
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(RejectionModel) {
  static constexpr const char* const names[] = {"normal", "published", nullptr};
  return names;
}

/// Of `reverse_mppi`.
struct PublishedReverseMppi {
  double inverse_variance_offset = 0;                 ///< as in `PublishedMppi`
  double normaliser_offset = 0;                       ///< as in `PublishedMppi`
  RejectionModel rejection = RejectionModel::normal;  ///< program: published
  /// Measure second moments in units of the present variance, but use them as variances all the same.
  /// Program: true, so that every variance is drawn towards 1.
  bool dimensionless_variance = false;
};

/// What the bandwidth of the kernel between the particles of `sv_mpc` is taken from.
enum class BandwidthModel {
  pair_distances,  ///< median squared distance between particles / log n (Liu and Wang 2016)
  squared_norms,   ///< median squared norm of the particles / log n (program)
};
/// The names of the enumerators, in order.
inline const char* const* enum_names(BandwidthModel) {
  static constexpr const char* const names[] = {"pair_distances", "squared_norms", nullptr};
  return names;
}

/// Of `sv_mpc`.
struct PublishedSvMpc {
  double inverse_variance_offset = 0;  ///< as in `PublishedMppi`
  double normaliser_offset = 0;        ///< as in `PublishedMppi`
  /// Add the control term of the weights to the costs in a gradient. Program: true, though the prior has its
  /// own gradient.
  bool gradient_control_term = false;
  BandwidthModel bandwidth = BandwidthModel::pair_distances;  ///< program: squared_norms
  /// Gradient of the log prior with the inverse of the inverse variance and the wrong sign. Program: true.
  bool inverted_prior = false;
  bool subtract_minimum = true;  ///< as in `PublishedSvgMppi`; program: false
  double gradient_floor = 0;     ///< as in `PublishedSvgMppi`; program: 1e-10
  bool clamp_particles = true;   ///< keep particles within the bounds; program: false
  /// Keep the sequence that is returned within the bounds. Program: false; then it may leave them as far as
  /// the particles do, and `Solver::keeps_bounds` is false.
  bool clamp_solution = true;
  /// Measure the prior's new variances in units of the old, but use them as variances all the same. Program:
  /// true.
  bool dimensionless_variance = false;
};

namespace detail {

template <class Published, class Visit>
void visit_published_offsets(Published& p, Visit&& visit) {
  visit(p.inverse_variance_offset,
        Declaration{.name = "inverse_variance_offset",
                    .unit = "1/input^2",
                    .help = "added to the inverse of every variance; paper's program: 1e-4",
                    .min = 0,
                    .max = 1e12});
  visit(p.normaliser_offset,
        Declaration{.name = "normaliser_offset",
                    .help = "added to the sum of the weights before dividing by it; paper's program: 1e-10",
                    .min = 0,
                    .max = 1});
}

template <class Published, class Visit>
void visit_published_gradient(Published& p, Visit&& visit) {
  visit(p.subtract_minimum,
        Declaration{
            .name = "subtract_minimum",
            .help = "compute the weights of a gradient relative to its best sample; paper's program: false"});
  visit(p.gradient_floor,
        Declaration{.name = "gradient_floor",
                    .help = "added to the sum of a gradient's weights; paper's program: 1e-10",
                    .min = 0,
                    .max = 1});
}

template <class Published, class Visit>
void visit_published_variance(Published& p, Visit&& visit) {
  visit(p.dimensionless_variance,
        Declaration{.name = "dimensionless_variance",
                    .help = "compute new variances relative to the old ones; paper's program: true"});
}

}  // namespace detail

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, PublishedMppi>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
}

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, PublishedSvgMppi>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
  detail::visit_published_gradient(p, visit);
  visit(p.clamp_guides,
        Declaration{.name = "clamp_guides", .help = "keep guides within the bounds; paper's program: false"});
  visit(p.fit_target, Declaration{.name = "fit_target",
                                  .symbol = "q*",
                                  .help = "what the Gaussian is fitted to; paper's program: state_cost"});
  visit(p.fit_temperature, Declaration{.name = "fit_temperature",
                                       .symbol = "lambda",
                                       .help = "temperature of the fit to state costs",
                                       .min = 1e-6,
                                       .max = 1e12});
  visit(p.fit_all_guides,
        Declaration{.name = "fit_all_guides",
                    .help = "fit to the paths of all guides together; paper's program: true"});
  visit(p.fit_standard_deviation,
        Declaration{.name = "fit_standard_deviation",
                    .help = "use the fitted standard deviation as the variance; paper's program: true"});
  visit(
      p.fit_absolute_curvature,
      Declaration{.name = "fit_absolute_curvature",
                  .help = "treat convex fits as concave ones of the same curvature; paper's program: true"});
}

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, PublishedReverseMppi>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
  visit(p.rejection, Declaration{.name = "rejection",
                                 .help = "densities used to reject samples; paper's program: published"});
  detail::visit_published_variance(p, visit);
}

/// Declares the options above.
template <class Options, class Visit>
requires is_options_of<Options, PublishedSvMpc>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
  detail::visit_published_gradient(p, visit);
  visit(
      p.gradient_control_term,
      Declaration{
          .name = "gradient_control_term",
          .help = "include the control term in gradients, in addition to the prior; paper's program: true"});
  visit(p.bandwidth,
        Declaration{
            .name = "bandwidth",
            .symbol = "h",
            .help = "values from which the kernel's bandwidth is computed; paper's program: squared_norms"});
  visit(p.inverted_prior,
        Declaration{.name = "inverted_prior",
                    .help = "gradient of the prior with wrong sign and scale; paper's program: true"});
  visit(p.clamp_particles, Declaration{.name = "clamp_particles",
                                       .help = "keep particles within the bounds; paper's program: false"});
  visit(p.clamp_solution,
        Declaration{.name = "clamp_solution",
                    .help = "keep the returned sequence within the bounds; paper's program: false"});
  detail::visit_published_variance(p, visit);
}

}  // namespace slalom
