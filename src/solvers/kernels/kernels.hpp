#pragma once

#include <cstddef>

#include "slalom/core/simd.hpp"

/// The inner loops of the solvers over batches [row][sample], row = step * inputs + input. Each is one
/// template over its scalar type (weight_kernels.hpp and others): `double` for reference, and packs of
/// float32, compiled once per instruction set behind the function pointers below.
namespace slalom::detail {

/// Values [row][sample], rows `stride` apart.
template <class Real>
struct Rows {
  Real* values = nullptr;
  std::ptrdiff_t stride = 0;
  int rows = 0;

  Real* row(int r) const { return values + r * stride; }
};

/// Where standard normal values are moved to: clamp(mean + deviation z, low, high), entries [row].
template <class Real>
struct SamplingDistribution {
  const Real* mean = nullptr;
  const Real* deviation = nullptr;
  const Real* low = nullptr;
  const Real* high = nullptr;
  int zero_mean_from = 0;  ///< samples from this index on are placed around zero instead of the mean
};

/// A run of samples. `first` and `count` are multiples of the lanes.
struct Range {
  int first = 0;
  int count = 0;
};

/// Sums over the samples of a range.
template <class Real>
struct WeightSums {
  Real weight = 0;   ///< sum of w
  Real squared = 0;  ///< sum of w^2
  Real cost = 0;     ///< sum of w times the cost given
};

/// What the samples of a range came to.
template <class Real>
struct CostStatistics {
  Real least_cost = 0;   ///< infinite if none is finite
  Real least_total = 0;  ///< likewise
  int finite = 0;        ///< totals
};

/// Sums over the samples of a range for two lists of weights, one after the other: w[k] v[row][k] and
/// w[k] (v[row][k] - centre[row])^2.
inline constexpr int moments = 4;

/// How gradients of particles are estimated: see surrogate_gradient.hpp. Exponents are
/// S / temperature + sum linear[row] v[row].
template <class Real>
struct ParticleGradients {
  int samples = 0;          ///< a particle
  int particle_stride = 0;  ///< from one sample of a particle to the next
  Real temperature = 1;
  bool subtract_minimum = true;
  Real floor = 0;
  const Real* linear = nullptr;            ///< [row]
  const Real* inverse_variance = nullptr;  ///< [row]
};

/// The densities in the published program's rejection, [row].
template <class Real>
struct RejectionRows {
  const Real* base = nullptr;  ///< density at the rejected mean
  const Real* rejected_mean = nullptr;
  const Real* rejected_inverse = nullptr;  ///< 1 / standard deviation
  const Real* rejected_scale = nullptr;    ///< 1 / sqrt(2 pi variance)
};

/// The float32 kernels of one instruction set.
struct Kernels {
  /// Moves normal values to samples; `noise` and `samples` may be the same.
  void (*place)(const Rows<float>& noise, const Rows<float>& samples, const SamplingDistribution<float>& to,
                Range range);
  /// totals[k] += sum over rows of coefficient[row] v[row][k].
  void (*add_linear)(const Rows<float>& v, const float* coefficient, Range range, float* totals);
  /// totals[k] += sum over rows of weight[row] (v[row][k] - centre[row])^2.
  void (*add_squared_distance)(const Rows<float>& v, const float* centre, const float* weight, Range range,
                               float* totals);
  /// Costs become +infinity where they are not finite, and likewise the totals, costs[k] + sum over rows of
  /// linear[row] v[row][k]; `linear` may be null.
  CostStatistics<float> (*finish)(const Rows<float>& v, const float* linear, Range range, float* costs,
                                  float* totals);
  /// Replaces what is not finite by +infinity.
  void (*make_finite)(Range range, float* costs);
  float (*minimum)(const float* costs, Range range);
  /// weights[k] = exp((least - totals[k]) / temperature), and sums over them with `costs` (infinite ones of
  /// weight 0 count nothing).
  WeightSums<float> (*exponential_weights)(const float* totals, const float* costs, float least,
                                           float temperature, Range range, float* weights);
  /// The same with the q-exponential of `index` q != 1: weights[k] = e_q((least - totals[k]) / temperature).
  WeightSums<float> (*tsallis_weights)(const float* totals, const float* costs, float least,
                                       float temperature, float index, Range range, float* weights);
  /// values[k] *= factor.
  void (*scale)(float factor, Range range, float* values);
  /// sums[row] = sum over samples of w[k] (v[row][k] - centre[row]).
  void (*weighted_sums)(const Rows<float>& v, const float* weights, const float* centre, Range range,
                        float* sums);
  /// sums[row] = sum over samples of w[k] (v[row][k] - centre[row])^2.
  void (*weighted_squares)(const Rows<float>& v, const float* weights, const float* centre, Range range,
                           float* sums);
  /// totals[k] = costs[k] + factor terms[k].
  void (*add_scaled)(const float* costs, float factor, const float* terms, Range range, float* totals);
  /// z <- L z over the rows first, first + step, ... with L lower triangular, row by row.
  void (*colour)(const Rows<float>& z, const float* factor, int first, int step, Range range);
  /// z <- z exp(s y - s^2), y laid out like z, s `spread` [row].
  void (*spread_log_normal)(const Rows<float>& z, const float* y, const float* spread, Range range);
  /// Gradients [row][particle]; `exponents` holds the samples' costs and becomes their weights.
  void (*particle_gradients)(const ParticleGradients<float>& how, const Rows<float>& samples,
                             const Rows<float>& theta, Range particles, float* exponents,
                             const Rows<float>& gradient);
  /// Normal values to `count` samples round each particle, in place.
  void (*place_round)(const Rows<float>& samples, const Rows<float>& theta,
                      const SamplingDistribution<float>& to, int particle_stride, int count, Range particles);
  /// SVGD's directions [row][particle] for the particles of a range.
  void (*stein_directions)(const Rows<float>& x, const Rows<float>& gradient, int count, float bandwidth,
                           Range particles, const Rows<float>& phi);
  /// sums[row * moments ...] of two lists of weights.
  void (*two_moments)(const Rows<float>& v, const float* first, const float* second, const float* centre,
                      Range range, float* sums);
  /// to[row][k] = from[row][indices[k]].
  void (*gather)(const Rows<float>& from, const int* indices, Range range, const Rows<float>& to);
  /// evaluated and rejected become the positive and the negative part of evaluated / falling - rejected /
  /// growing; their sums are `weight` and `squared`.
  WeightSums<float> (*split_weights)(float falling, float growing, Range range, float* evaluated,
                                     float* rejected);
  /// Logarithms of the inverse of the published program's probabilities of keeping samples.
  void (*published_rejection)(const Rows<float>& v, const RejectionRows<float>& densities, Range range,
                              float* logarithms);
  /// The same for normal densities, from squared distances in units of the variances; replaces `own`.
  void (*rejection_logarithm)(const float* rejected, float offset, Range range, float* own);
};

/// Those of the instruction set in use.
const Kernels& kernels();
/// Those of one instruction set.
const Kernels& kernels(simd::Target target);

}  // namespace slalom::detail
