#pragma once

#include "slalom/core/options.hpp"

/// Reproduction of the published program of Honda et al. (ICRA 2024). This folder holds the options that
/// exist only for it: each of the methods' aggregates has one of the aggregates below as its member
/// `published`. Their defaults are the methods as the papers have them; configs/published.yaml has the values
/// of the program. docs/paper.md lists every departure of the program from the paper.
namespace slalom {

/// Options of `mppi` that reproduce the program. `visit_options` below describes the fields.
struct PublishedMppi {
  double inverse_variance_offset = 0;
  double normaliser_offset = 0;
};

/// The target of the Gaussian's fit along a guide's path.
enum class FitTarget {
  optimal_density,  ///< q* of the paper's equation (5): exp(-S / temperature) q(V | nominal, Sigma)
  state_cost,       ///< softmax of S with `fit_temperature` (program)
};
inline const char* const* enum_names(FitTarget) {
  static constexpr const char* const names[] = {"optimal_density", "state_cost", nullptr};
  return names;
}

/// Options of `svg_mppi` that reproduce the program. `visit_options` below describes the fields.
struct PublishedSvgMppi {
  double inverse_variance_offset = 0;
  double normaliser_offset = 0;
  /// Otherwise a guide (or particle) whose samples are all bad stands still.
  bool subtract_minimum = true;
  double gradient_floor = 0;
  bool clamp_guides = true;
  FitTarget fit_target = FitTarget::optimal_density;
  double fit_temperature = 0.1;
  bool fit_all_guides = false;
  /// The paper's equation (13) can be read so, though Sigma is a variance everywhere else.
  bool fit_standard_deviation = false;
  /// With true the normal equations are solved as they are. Otherwise a convex fit determines nothing, and
  /// the variance is `variance_max`.
  bool fit_absolute_curvature = false;
};

/// The densities by which `reverse_mppi` rejects samples.
enum class RejectionModel {
  normal,     ///< a sample is kept with probability p / (p + p_rejected), normal densities at the sample
  published,  ///< product over steps of 1 / (p + p_rejected) where a "density" grows with the distance, and p
              ///< is taken at the rejected mean (program)
};
inline const char* const* enum_names(RejectionModel) {
  static constexpr const char* const names[] = {"normal", "published", nullptr};
  return names;
}

/// Options of `reverse_mppi` that reproduce the program. `visit_options` below describes the fields.
struct PublishedReverseMppi {
  double inverse_variance_offset = 0;
  double normaliser_offset = 0;
  RejectionModel rejection = RejectionModel::normal;
  bool dimensionless_variance = false;  ///< With true every variance is drawn towards 1.
};

/// The source of the bandwidth of the kernel between the particles of `sv_mpc`.
enum class BandwidthModel {
  pair_distances,  ///< median squared distance between particles / log n (Liu and Wang 2016)
  squared_norms,   ///< median squared norm of the particles / log n (program)
};
inline const char* const* enum_names(BandwidthModel) {
  static constexpr const char* const names[] = {"pair_distances", "squared_norms", nullptr};
  return names;
}

/// Options of `sv_mpc` that reproduce the program. `visit_options` below describes the fields.
struct PublishedSvMpc {
  double inverse_variance_offset = 0;
  double normaliser_offset = 0;
  bool gradient_control_term = false;
  BandwidthModel bandwidth = BandwidthModel::pair_distances;
  bool inverted_prior = false;
  /// Otherwise a guide (or particle) whose samples are all bad stands still.
  bool subtract_minimum = true;
  double gradient_floor = 0;
  bool clamp_particles = true;
  /// If false, the sequence may leave the bounds as far as the particles do: `Solver::keeps_bounds` is false.
  bool clamp_solution = true;
  bool dimensionless_variance = false;  ///< With true every variance is drawn towards 1.
};

namespace detail {

template <class Published, class Visit>
void visit_published_offsets(Published& p, Visit&& visit) {
  visit(p.inverse_variance_offset,
        {"inverse_variance_offset", "1/input^2",
         "added to the inverse of every variance; paper's program: 1e-4", 0, 1e12});
  visit(p.normaliser_offset,
        {"normaliser_offset", "",
         "added to the sum of the weights before dividing by it; paper's program: 1e-10", 0, 1});
}

template <class Published, class Visit>
void visit_published_gradient(Published& p, Visit&& visit) {
  visit(p.subtract_minimum,
        {"subtract_minimum", "",
         "compute the weights of a gradient relative to its best sample; paper's program: false"});
  visit(p.gradient_floor,
        {"gradient_floor", "", "added to the sum of a gradient's weights; paper's program: 1e-10", 0, 1});
}

template <class Published, class Visit>
void visit_published_variance(Published& p, Visit&& visit) {
  visit(p.dimensionless_variance, {"dimensionless_variance", "",
                                   "compute new variances relative to the old ones; paper's program: true"});
}

}  // namespace detail

template <class Options, class Visit>
requires is_options_of<Options, PublishedMppi>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
}

template <class Options, class Visit>
requires is_options_of<Options, PublishedSvgMppi>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
  detail::visit_published_gradient(p, visit);
  visit(p.clamp_guides, {"clamp_guides", "", "keep guides within the bounds; paper's program: false"});
  visit(p.fit_target, {"fit_target", "", "target of the Gaussian's fit; paper's program: state_cost",
                       -no_limit, no_limit, "q*"});
  visit(p.fit_temperature,
        {"fit_temperature", "", "temperature of the fit to state costs", 1e-6, 1e12, "lambda"});
  visit(p.fit_all_guides,
        {"fit_all_guides", "", "fit to the paths of all guides together; paper's program: true"});
  visit(p.fit_standard_deviation,
        {"fit_standard_deviation", "",
         "use the fitted standard deviation as the variance; paper's program: true"});
  visit(p.fit_absolute_curvature,
        {"fit_absolute_curvature", "",
         "treat convex fits as concave ones of the same curvature; paper's program: true"});
}

template <class Options, class Visit>
requires is_options_of<Options, PublishedReverseMppi>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
  visit(p.rejection, {"rejection", "", "densities used to reject samples; paper's program: published"});
  detail::visit_published_variance(p, visit);
}

template <class Options, class Visit>
requires is_options_of<Options, PublishedSvMpc>
void visit_options(Options& p, Visit&& visit) {
  detail::visit_published_offsets(p, visit);
  detail::visit_published_gradient(p, visit);
  visit(p.gradient_control_term,
        {"gradient_control_term", "",
         "include the control term in gradients, in addition to the prior; paper's program: true"});
  visit(p.bandwidth, {"bandwidth", "", "source of the kernel's bandwidth; paper's program: squared_norms",
                      -no_limit, no_limit, "h"});
  visit(p.inverted_prior,
        {"inverted_prior", "", "gradient of the prior with wrong sign and scale; paper's program: true"});
  visit(p.clamp_particles,
        {"clamp_particles", "", "keep particles within the bounds; paper's program: false"});
  visit(p.clamp_solution,
        {"clamp_solution", "", "keep the returned sequence within the bounds; paper's program: false"});
  detail::visit_published_variance(p, visit);
}

}  // namespace slalom
