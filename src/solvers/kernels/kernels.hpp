#pragma once

#include <cstddef>

#include "slalom/core/instruction_set.hpp"

/// The inner loops of the solvers over batches [row][sample], row = step * inputs + input. Each is a kernel
/// (see core/dispatch.hpp) in weight_kernels.hpp, noise_kernels.hpp or particle_kernels.hpp. It is compiled
/// for packs of float32 of every instruction set, and for `double` as a reference.
namespace slalom::detail {

/// A view of values [row][sample]; `stride` is the distance from one row to the next.
template <class Real>
struct Rows {
  Real* values = nullptr;
  std::ptrdiff_t stride = 0;
  int rows = 0;

  /// The first value of a row.
  Real* row(int r) const { return values + r * stride; }
};

/// The distribution of samples: independent normal values with this mean and standard deviation, clamped to
/// [low, high]. Arrays are [row].
template <class Real>
struct SamplingDistribution {
  const Real* mean = nullptr;
  const Real* deviation = nullptr;
  const Real* low = nullptr;
  const Real* high = nullptr;
  int zero_mean_from = 0;  ///< the first sample that is drawn around zero instead of the mean
};

/// A range of samples. `first` and `count` are multiples of the lanes.
struct Range {
  int first = 0;
  int count = 0;
};

/// Sums over the samples of a range.
template <class Real>
struct WeightSums {
  Real weight = 0;   ///< sum of w
  Real squared = 0;  ///< sum of w^2
  Real cost = 0;     ///< sum of w * cost
};

/// Statistics of the costs of a range of samples.
template <class Real>
struct CostStatistics {
  Real min_cost = 0;   ///< lowest cost; infinite if none is finite
  Real min_total = 0;  ///< lowest total; infinite if none is finite
  int finite = 0;      ///< number of finite totals
};

/// Number of sums per row in `two_moments`: the sums of w[k] v[row][k] and w[k] (v[row][k] - centre[row])^2
/// over the samples of a range, for two lists of weights.
inline constexpr int moments = 4;

/// Settings of the gradient estimate of particles: see surrogate_gradient.hpp. The exponents are
/// S / temperature + sum linear[row] v[row].
template <class Real>
struct GradientSettings {
  int samples = 0;          ///< samples per particle
  int particle_stride = 0;  ///< distance from one sample of a particle to the next
  Real temperature = 1;
  bool subtract_minimum = true;
  Real floor = 0;
  const Real* linear = nullptr;            ///< [row]
  const Real* inverse_variance = nullptr;  ///< [row]
};

/// The densities by which the paper's program rejects samples, [row].
template <class Real>
struct RejectionRows {
  const Real* base = nullptr;  ///< density at the rejected mean
  const Real* rejected_mean = nullptr;
  const Real* rejected_inverse = nullptr;  ///< 1 / standard deviation
  const Real* rejected_scale = nullptr;    ///< 1 / sqrt(2 pi variance)
};

/// The float32 kernels of one instruction set, or the reference kernels for `double`. All arrays are padded
/// to whole packs.
template <class Real>
struct Kernels {
  /// Makes samples of standard normal values: clamp(mean + deviation z, low, high). `noise` and `samples` may
  /// be the same.
  void (*sample)(const Rows<Real>& noise, const Rows<Real>& samples, const SamplingDistribution<Real>& to,
                 Range range);
  /// totals[k] += sum over rows of coefficient[row] v[row][k].
  void (*add_linear)(const Rows<Real>& v, const Real* coefficient, Range range, Real* totals);
  /// totals[k] += sum over rows of weight[row] (v[row][k] - centre[row])^2.
  void (*add_squared_distance)(const Rows<Real>& v, const Real* centre, const Real* weight, Range range,
                               Real* totals);
  /// totals[k] = costs[k] + sum over rows of linear[row] v[row][k]; `linear` may be null. Costs and totals
  /// that are not finite become +infinity.
  CostStatistics<Real> (*finish)(const Rows<Real>& v, const Real* linear, Range range, Real* costs,
                                 Real* totals);
  /// Replaces costs that are not finite by +infinity.
  void (*make_finite)(Range range, Real* costs);
  /// The lowest cost of a range.
  Real (*minimum)(const Real* costs, Range range);
  /// weights[k] = exp((least - totals[k]) / temperature). Returns their sums; a cost with weight 0 adds
  /// nothing, even if it is infinite.
  WeightSums<Real> (*exponential_weights)(const Real* totals, const Real* costs, Real least, Real temperature,
                                          Range range, Real* weights);
  /// The same for the q-exponential with `index` q != 1: weights[k] = e_q((least - totals[k]) / temperature).
  WeightSums<Real> (*tsallis_weights)(const Real* totals, const Real* costs, Real least, Real temperature,
                                      Real index, Range range, Real* weights);
  /// values[k] *= factor.
  void (*scale)(Real factor, Range range, Real* values);
  /// sums[row] = sum over samples of w[k] (v[row][k] - centre[row]).
  void (*weighted_sums)(const Rows<Real>& v, const Real* weights, const Real* centre, Range range,
                        Real* sums);
  /// sums[row] = sum over samples of w[k] (v[row][k] - centre[row])^2.
  void (*weighted_squares)(const Rows<Real>& v, const Real* weights, const Real* centre, Range range,
                           Real* sums);
  /// totals[k] = costs[k] + factor terms[k].
  void (*add_scaled)(const Real* costs, Real factor, const Real* terms, Range range, Real* totals);
  /// z <- L z over the rows first, first + step, ... `factor` is the lower triangular L, row by row.
  void (*colour)(const Rows<Real>& z, const Real* factor, int first, int step, Range range);
  /// z <- z exp(s y - s^2), where `y` has the layout of z and `spread` [row] is s.
  void (*spread_log_normal)(const Rows<Real>& z, const Real* y, const Real* spread, Range range);
  /// Gradients [row][particle]. `exponents` holds the samples' costs and is replaced by their weights.
  void (*particle_gradients)(const GradientSettings<Real>& how, const Rows<Real>& samples,
                             const Rows<Real>& theta, Range particles, Real* exponents,
                             const Rows<Real>& gradient);
  /// Makes `count` samples around each particle theta from standard normal values, in place:
  /// clamp(theta + deviation z, low, high). `to.zero_mean_from` counts the samples of a particle.
  void (*sample_around)(const Rows<Real>& samples, const Rows<Real>& theta,
                        const SamplingDistribution<Real>& to, int particle_stride, int count,
                        Range particles);
  /// The directions phi of SVGD (see stein.hpp), [row][particle], for the particles of a range.
  void (*stein_directions)(const Rows<Real>& x, const Rows<Real>& gradient, int count, Real bandwidth,
                           Range particles, const Rows<Real>& phi);
  /// sums[row * moments ...] for two lists of weights: see `moments`.
  void (*two_moments)(const Rows<Real>& v, const Real* first, const Real* second, const Real* centre,
                      Range range, Real* sums);
  /// to[row][k] = from[row][indices[k]].
  void (*gather)(const Rows<Real>& from, const int* indices, Range range, const Rows<Real>& to);
  /// Replaces `evaluated` and `rejected` by the positive and the negative part of
  /// evaluated / falling - rejected / growing. Returns their sums as `weight` and `squared`.
  WeightSums<Real> (*split_weights)(Real falling, Real growing, Range range, Real* evaluated, Real* rejected);
  /// -log of the probabilities with which the paper's program keeps samples.
  void (*published_rejection)(const Rows<Real>& v, const RejectionRows<Real>& densities, Range range,
                              Real* logarithms);
  /// The same for normal densities, given squared distances in units of the variances. Replaces `own`.
  void (*rejection_logarithm)(const Real* rejected, Real offset, Range range, Real* own);
};

/// The float32 kernels of the active instruction set, or the reference kernels for `double`.
template <class Real = float>
const Kernels<Real>& kernels();
template <>
const Kernels<float>& kernels<float>();
template <>
const Kernels<double>& kernels<double>();

/// The float32 kernels of one instruction set.
const Kernels<float>& kernels(simd::Target target);

}  // namespace slalom::detail
