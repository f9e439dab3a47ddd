#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "slalom/core/sequence_batch.hpp"

/// The inner loops of the solvers over batches [row][sample], row = step * inputs + input. Each loop runs on
/// packs of float32 of the widest instruction set (core/dispatch.hpp). All arrays are padded to whole packs.
namespace slalom::detail {

/// A view of values [row][sample]; `stride` is the distance from one row to the next.
struct Rows {
  float* values = nullptr;
  std::ptrdiff_t stride = 0;
  int rows = 0;

  /// The first value of a row.
  float* row(int r) const { return values + r * stride; }
};

/// The distribution of samples: independent normal values with this mean and standard deviation, clamped to
/// [low, high]. Arrays are [row].
struct SamplingDistribution {
  const float* mean = nullptr;
  const float* deviation = nullptr;
  const float* low = nullptr;
  const float* high = nullptr;
  int zero_mean_from = 0;  ///< the first sample that is drawn around zero instead of the mean
};

/// Samples of several distributions side by side. Each sample follows one `source`.
struct Mixture {
  /// Independent normal values, [row].
  struct Source {
    const float* mean = nullptr;
    const float* deviation = nullptr;
  };

  std::span<const Source> sources;
  const float* source = nullptr;  ///< the index of a sample's source [sample]
  const float* scale = nullptr;   ///< the factor of a sample's deviations [sample]
  const float* white = nullptr;   ///< 1 for samples with white noise, 0 for those with shaped noise [sample]
  const float* low = nullptr;     ///< bounds [row]
  const float* high = nullptr;    ///< bounds [row]
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

  /// The effective sample size; 0 without weights.
  double effective() const noexcept {
    const double w = weight;
    return squared > 0 ? w * w / squared : 0;
  }
};

/// Statistics of the costs of a range of samples.
struct CostStatistics {
  float min_cost = 0;   ///< lowest cost; infinite if none is finite
  float min_total = 0;  ///< lowest total; infinite if none is finite
  int finite = 0;       ///< number of finite totals
};

/// Number of sums per row in `two_moments`: the sums of w[k] v[row][k] and w[k] (v[row][k] - centre[row])^2
/// over the samples of a range, for two lists of weights.
inline constexpr int moments = 4;

/// Settings of the gradient estimate of particles (see `SurrogateGradient` in guides.hpp). The exponents are
/// S / temperature + sum linear[row] v[row].
struct GradientSettings {
  int samples = 0;          ///< samples per particle
  int particle_stride = 0;  ///< distance from one sample of a particle to the next
  float temperature = 1;
  bool subtract_minimum = true;
  float floor = 0;
  const float* linear = nullptr;            ///< [row]
  const float* inverse_variance = nullptr;  ///< [row]
};

/// The densities by which the paper's program rejects samples, [row].
struct RejectionRows {
  const float* base = nullptr;  ///< density at the rejected mean
  const float* rejected_mean = nullptr;
  const float* rejected_inverse = nullptr;  ///< 1 / standard deviation
  const float* rejected_scale = nullptr;    ///< 1 / sqrt(2 pi variance)
};

/// The rows of a batch.
inline Rows rows_of(SequenceBatch& batch) noexcept {
  return {batch.data(), batch.stride(), batch.rows()};
}

/// A row-major matrix. Indices are `int`; offsets are computed in `std::ptrdiff_t`.
template <class T>
class Matrix {
 public:
  Matrix() = default;
  /// All entries 0.
  Matrix(int rows, int columns) : columns_(columns), values_(rows * columns_) {}

  /// The first entry of a row.
  T* operator[](int row) noexcept { return values_.data() + row * columns_; }
  /// The first entry of a row.
  const T* operator[](int row) const noexcept { return values_.data() + row * columns_; }

  /// All entries, row after row.
  std::vector<T>& values() noexcept { return values_; }
  /// All entries, row after row.
  const std::vector<T>& values() const noexcept { return values_; }

 private:
  std::ptrdiff_t columns_ = 0;
  std::vector<T> values_;
};

namespace kernels {

/// Turns standard normal values z into samples, clamp(mean + deviation z, low, high). `noise` and `samples`
/// may be the same.
void sample(const Rows& noise, const Rows& samples, const SamplingDistribution& to, Range range);
/// Turns standard normal values, white and shaped, into samples of a mixture, clamped to its bounds. `shaped`
/// and `samples` may be the same.
void sample_mixture(const Rows& white, const Rows& shaped, const Rows& samples, const Mixture& from,
                    Range range);
/// totals[k] += sum over rows of coefficient[row] v[row][k].
void add_linear(const Rows& v, const float* coefficient, Range range, float* totals);
/// totals[k] += sum over rows of weight[row] (v[row][k] - centre[row])^2.
void add_squared_distance(const Rows& v, const float* centre, const float* weight, Range range,
                          float* totals);
/// totals[k] = costs[k] + sum over rows of linear[row] v[row][k]; `linear` may be null. Costs and totals
/// that are not finite become +infinity.
CostStatistics finish(const Rows& v, const float* linear, Range range, float* costs, float* totals);
/// Replaces costs that are not finite by +infinity.
void make_finite(Range range, float* costs);
/// The lowest cost of a range.
float minimum(const float* costs, Range range);
/// weights[k] = exp((least - totals[k]) / temperature). Returns their sums; a cost with weight 0 adds
/// nothing, even if it is infinite.
WeightSums<float> exponential_weights(const float* totals, const float* costs, float least, float temperature,
                                      Range range, float* weights);
/// values[k] *= factor.
void scale(float factor, Range range, float* values);
/// sums[row] = sum over samples of w[k] (v[row][k] - centre[row]).
void weighted_sums(const Rows& v, const float* weights, const float* centre, Range range, float* sums);
/// sums[row] = sum over samples of w[k] (v[row][k] - centre[row])^2.
void weighted_squares(const Rows& v, const float* weights, const float* centre, Range range, float* sums);
/// totals[k] = costs[k] + factor terms[k].
void add_scaled(const float* costs, float factor, const float* terms, Range range, float* totals);
/// z <- L z over the rows first, first + step, ... `factor` is the lower triangular L, row by row.
void colour(const Rows& z, const float* factor, int first, int step, Range range);
/// Gradients [row][particle]. `exponents` holds the samples' costs and is replaced by their weights.
void particle_gradients(const GradientSettings& how, const Rows& samples, const Rows& theta, Range particles,
                        float* exponents, const Rows& gradient);
/// Turns standard normal values z into `count` samples around each particle theta, in place:
/// clamp(theta + deviation z, low, high). `to.zero_mean_from` counts the samples of a particle.
void sample_around(const Rows& samples, const Rows& theta, const SamplingDistribution& to,
                   int particle_stride, int count, Range particles);
/// The directions phi of SVGD (see stein.hpp), [row][particle], for the particles of a range.
void stein_directions(const Rows& x, const Rows& gradient, int count, float bandwidth, Range particles,
                      const Rows& phi);
/// sums[row * moments ...] for two lists of weights: see `moments`.
void two_moments(const Rows& v, const float* first, const float* second, const float* centre, Range range,
                 float* sums);
/// to[row][k] = from[row][indices[k]].
void gather(const Rows& from, const int* indices, Range range, const Rows& to);
/// Replaces `evaluated` and `rejected` by the positive and the negative part of
/// evaluated / falling - rejected / growing. Returns their sums as `weight` and `squared`.
WeightSums<float> split_weights(float falling, float growing, Range range, float* evaluated, float* rejected);
/// Computes -log of the probabilities with which the paper's program keeps samples.
void published_rejection(const Rows& v, const RejectionRows& densities, Range range, float* logarithms);
/// Computes the same for normal densities, given squared distances in units of the variances. Replaces `own`.
void rejection_logarithm(const float* rejected, float offset, Range range, float* own);

}  // namespace kernels

}  // namespace slalom::detail
