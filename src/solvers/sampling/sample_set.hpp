#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/random.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/core/thread_pool.hpp"
#include "slalom/solvers/solver_base.hpp"
#include "solvers/kernels/kernels.hpp"
#include "solvers/sampling/noise_shape.hpp"

namespace slalom::detail {

using Clock = Deadline::Clock;

/// Seconds between two points in time.
inline double seconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

/// Statistics of a batch of samples.
struct BatchStatistics {
  float minimum_total = 0;   ///< lowest cost with the control term; infinite if none is finite
  float minimum_cost = 0;    ///< lowest cost without the control term; infinite if none is finite
  int finite = 0;            ///< samples whose cost is finite
  int collided = 0;          ///< samples that collide
  int evaluated = 0;         ///< samples that were drawn and evaluated before the deadline
  double draw_time = 0;      ///< s, summed over threads
  double evaluate_time = 0;  ///< s, summed over threads

  BatchStatistics& operator+=(const BatchStatistics& other) noexcept {
    minimum_total = std::min(minimum_total, other.minimum_total);
    minimum_cost = std::min(minimum_cost, other.minimum_cost);
    finite += other.finite;
    collided += other.collided;
    evaluated += other.evaluated;
    draw_time += other.draw_time;
    evaluate_time += other.evaluate_time;
    return *this;
  }
};

/// A set of control sequences with their costs and weights. Work is divided into tiles of samples that fit
/// the first-level cache. The tiles do not depend on the number of threads, and their results are combined in
/// their order.
class SampleSet {
 public:
  SampleSet(int steps, int inputs, int samples, NoiseShape shape = {});

  const NoiseShape& shape() const noexcept { return shape_; }
  int samples() const noexcept { return values_.samples(); }
  /// Draws so many samples from now on, at most as many as at construction.
  void set_samples(int samples) noexcept { values_.set_samples(samples); }
  /// Draws white noise from now on, or again noise of its shape.
  void set_white(bool white) noexcept { white_ = white; }
  int rows() const noexcept { return values_.rows(); }
  const SequenceBatch& values() const noexcept { return values_; }
  SequenceBatch& values() noexcept { return values_; }
  int stride() const noexcept { return values_.stride(); }
  Rows row_view() noexcept { return rows_of(values_); }

  /// Costs [sample]; infinite if the evaluator's cost is not finite or the deadline passed before.
  std::span<const float> costs() const noexcept { return {costs_.data(), count()}; }
  /// Costs with the control term [sample].
  std::span<const float> totals() const noexcept { return {totals_.data(), count()}; }
  std::span<float> totals() noexcept { return {totals_.data(), count()}; }
  std::span<const std::uint8_t> collided() const noexcept { return {collided_.data(), count()}; }
  std::span<const float> weights() const noexcept { return {weights_.data(), count()}; }
  std::span<float> weights() noexcept { return {weights_.data(), count()}; }

  /// Draws the normal values for `key` in advance.
  void prepare(RandomKey key, ThreadPool& pool) noexcept;
  /// Draws the normal values in parts: call `begin_prepare`, then `prepare_tile` for any of the `tiles()`
  /// tiles, also from several threads. The values of other tiles are drawn when the tiles are evaluated.
  void begin_prepare(RandomKey key) noexcept;
  void prepare_tile(int tile, RandomKey key) noexcept;
  /// Whether samples for this evaluator and `key` need normal values that have not been drawn.
  bool lacks_noise(const BatchEvaluator& evaluator, RandomKey key) const noexcept;
  int tiles() const noexcept { return (values_.stride() + tile_ - 1) / tile_; }

  /// Makes these sequences, moved into the bounds, the last samples of every draw. They must stay valid until
  /// the next call. If there are more sequences than samples, the first ones are used.
  void propose(const SequenceList& proposals) noexcept;
  /// The number of samples that are proposals.
  int proposed() const noexcept { return proposed_; }

  /// Draws and evaluates the samples. Their totals are cost + sum of linear[row] v[row]; `linear` may be
  /// null. The `known` sequences take the places before the proposals, the first one the last. Omits tiles
  /// that have not started at the deadline.
  BatchStatistics draw_and_evaluate(const BatchEvaluator& evaluator, RandomKey key,
                                    const SamplingDistribution& to, const float* linear, ThreadPool& pool,
                                    const Deadline& deadline, const SequenceList& known = {}) noexcept;

  /// Draws and evaluates samples of a mixture, before which stand the `known` sequences and the proposals.
  /// The set draws white noise (`set_white`), which a part of the samples shapes. Omits tiles as above.
  BatchStatistics draw_and_evaluate(const BatchEvaluator& evaluator, RandomKey key, const Mixture& from,
                                    const SequenceList& known, ThreadPool& pool,
                                    const Deadline& deadline) noexcept;

  /// Draws the samples without evaluating them, with normal noise.
  void draw(RandomKey key, const SamplingDistribution& to, ThreadPool& pool) noexcept;

  /// Evaluates the present values.
  BatchStatistics evaluate(const BatchEvaluator& evaluator, const float* linear, ThreadPool& pool,
                           const Deadline& deadline) noexcept;

  /// Stores sum of linear[row] v[row] of each sample for `mix_totals`.
  void keep_terms(const float* linear, ThreadPool& pool) noexcept;
  /// Sets the totals to cost + factor * term and returns the lowest.
  float mix_totals(float factor, ThreadPool& pool) noexcept;

  /// Sets the weights to exp((least - total) / temperature), not normalised, and returns their sums.
  WeightSums<double> weigh(float least, float temperature, ThreadPool& pool) noexcept;

  /// Sums over the present weights of the first `count` samples.
  WeightSums<double> sum_weights(int count) const noexcept;

  /// Multiplies the weights by a factor, then computes sums[row] = sum of w (v - centre).
  void weighted_sums(const float* centre, double* sums, ThreadPool& pool, double factor = 1) noexcept;
  /// sums[row] = sum of w (v - centre)^2.
  void weighted_squares(const float* centre, double* sums, ThreadPool& pool) noexcept;
  /// sums[row * moments ...] for two lists of weights [padded sample]: the sums of w v and w (v - centre)^2
  /// of the first list, then of the second.
  void two_moments(const float* first, const float* second, const float* centre, double* sums,
                   ThreadPool& pool) noexcept;

 private:
  std::size_t count() const noexcept { return static_cast<std::size_t>(values_.samples()); }
  bool prepared_for(RandomKey key) const noexcept {
    return prepared_key_.seed == key.seed && prepared_key_.stream == key.stream;
  }
  Range range(int tile) const noexcept { return part(tile, tile_); }
  /// Part `index` of the set, divided into parts of `size` samples.
  Range part(int index, int size) const noexcept {
    return {index * size, std::min(size, values_.stride() - index * size)};
  }
  int part_size(int threads) const noexcept;
  bool prepared(Range range) const noexcept;
  void fill_noise(const Sampler* sampler, SequenceBatch& to, Range range, RandomKey key) noexcept;
  void sample_range(const Sampler* sampler, RandomKey key, const SamplingDistribution& to,
                    const SequenceList& known, bool ready, Range range) noexcept;
  void sample_range(const Sampler* sampler, RandomKey key, const Mixture& from, const SequenceList& known,
                    bool ready, Range range) noexcept;
  void place_proposals(int first, const float* mean, const float* low, const float* high,
                       Range range) noexcept;
  template <class Draw>
  BatchStatistics draw_and_evaluate(const BatchEvaluator& evaluator, RandomKey key, const float* linear,
                                    ThreadPool& pool, const Deadline& deadline, Draw&& draw) noexcept;
  template <class Each>
  BatchStatistics run_parts(ThreadPool& pool, const Deadline& deadline, Each&& each) noexcept;
  BatchStatistics evaluate_whole(const BatchEvaluator& evaluator, const float* linear, ThreadPool& pool,
                                 const Deadline& deadline) noexcept;
  void finish(Range range, const BatchEvaluator* evaluator, const float* linear,
              BatchStatistics& statistics) noexcept;
  void skip(Range range, BatchStatistics& statistics) noexcept;
  template <class Each>
  void add_tiles(int count, double* sums, ThreadPool& pool, Each&& each) noexcept;

  SequenceBatch values_;
  SequenceBatch noise_;
  NoiseShape shape_;
  bool white_ = false;
  const float* proposals_ = nullptr;  ///< [proposal][row]
  int proposed_ = 0;
  RandomKey prepared_key_;
  AlignedBuffer costs_, totals_, weights_, terms_;
  std::vector<std::uint8_t> collided_;
  int tile_;
  std::vector<std::uint8_t> prepared_;          ///< whether `noise_` is that of `prepared_key_` [tile]
  std::vector<BatchStatistics> statistics_;     ///< [part], see part_size
  std::vector<WeightSums<float>> weight_sums_;  ///< [tile]
  std::vector<float> least_;                    ///< [tile]
  Matrix<float> tile_sums_;                     ///< [tile][sum]
  int reached_;                                 ///< tiles of the last evaluation before the deadline
};

/// 1 / variance + offset; 0 for an input that is not sampled (variance 0).
template <class Real>
Real inverse_variance(Real variance, Real offset) noexcept {
  return variance > 0 ? Real(1) / variance + offset : Real(0);
}

/// Points the spans of a result to the samples of `set`.
void bind_samples(const SampleSet& set, SolveResult& result) noexcept;

/// Writes the samples of `set`, their statistics but the times, and the sums of their weights to a result.
void report_samples(const SampleSet& set, const BatchStatistics& statistics, const WeightSums<double>& sums,
                    SolveResult& result) noexcept;

}  // namespace slalom::detail
