#include "solvers/sampling/sample_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slalom::detail {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// Rollouts process up to four packs at a time.
constexpr int together = 4 * simd::padding;

/// Samples per tile. Their values fill about 32 KiB.
int tile_size(int rows) {
  const int fitting = 32768 / (4 * std::max(rows, 1)) / together * together;
  return std::clamp(fitting, together, 512);
}

}  // namespace

SampleSet::SampleSet(int steps, int inputs, int samples, NoiseShape shape)
    : values_(steps, inputs, samples),
      noise_(steps, inputs, samples),
      shape_(std::move(shape)),
      costs_(padded(samples)),
      totals_(padded(samples)),
      weights_(padded(samples)),
      terms_(padded(samples)),
      collided_(padded(samples)),
      tile_(tile_size(steps * inputs)),
      prepared_(tiles()),
      statistics_(2 * tiles()),
      weight_sums_(tiles()),
      least_(tiles()),
      tile_sums_(tiles(), steps * inputs * moments),
      reached_(tiles()) {}

/// Fills a range of samples with noise: values of the problem's sampler, or normal values if it has none.
/// Then gives the noise its shape.
void SampleSet::fill_noise(const Sampler* sampler, SequenceBatch& to, Range r, RandomKey key) noexcept {
  if (sampler) {
    sampler->fill(to, r.first, r.count, key);
  } else {
    fill_normal(to, r.first, r.count, key);
  }
  if (shape_.correlated() && !white_) shape_.apply(to, r);
}

void SampleSet::prepare(RandomKey key, ThreadPool& pool) noexcept {
  begin_prepare(key);
  pool.run(tiles(), [&](int tile) { prepare_tile(tile, key); });
}

void SampleSet::begin_prepare(RandomKey key) noexcept {
  std::fill(prepared_.begin(), prepared_.end(), std::uint8_t{0});
  prepared_key_ = key;
}

void SampleSet::prepare_tile(int tile, RandomKey key) noexcept {
  fill_noise(nullptr, noise_, range(tile), key);
  prepared_[tile] = 1;
}

bool SampleSet::lacks_noise(const BatchEvaluator& evaluator, RandomKey key) const noexcept {
  const bool all = std::find(prepared_.begin(), prepared_.end(), 0) == prepared_.end();
  return !evaluator.sampler() && !(all && prepared_for(key));
}

/// Evaluates a range if `evaluator` is not null. Sets costs that are not finite, and those in the padding, to
/// infinity. Computes the totals and statistics of the range.
void SampleSet::finish(Range r, const BatchEvaluator* evaluator, const float* linear,
                       BatchStatistics& statistics) noexcept {
  const int count = std::clamp(samples() - r.first, 0, r.count);
  if (evaluator && count > 0) evaluator->evaluate(values_, r.first, count, costs_.data(), collided_.data());
  for (int i = r.first + count; i < r.first + r.count; ++i) {
    costs_[i] = infinite;
    collided_[i] = 0;
  }
  const CostStatistics found = kernels::finish(row_view(), linear, r, costs_.data(), totals_.data());
  statistics.minimum_cost = found.min_cost;
  statistics.minimum_total = found.min_total;
  statistics.finite = found.finite;
  statistics.evaluated = count;
  const std::uint8_t* hit = collided_.data() + r.first;
  for (int i = 0; i < count; ++i) statistics.collided += hit[i] != 0;
}

void SampleSet::skip(Range r, BatchStatistics& statistics) noexcept {
  std::fill_n(costs_.data() + r.first, r.count, infinite);
  std::fill_n(totals_.data() + r.first, r.count, infinite);
  std::fill_n(collided_.data() + r.first, r.count, std::uint8_t{0});
  statistics.minimum_cost = statistics.minimum_total = infinite;
}

/// Returns how many samples are drawn and evaluated at a time. No result depends on it.
int SampleSet::part_size(int threads) const noexcept {
  constexpr int wanted = 256;
  const int enough_tiles = (wanted + tile_ - 1) / tile_;
  if (threads == 1) return tile_ * enough_tiles;                  // short loops cost 6 % with 200 rows
  const bool halves_are_whole = tile_ % (2 * together) == 0;      // groups of packs
  return tile_ > wanted && halves_are_whole ? tile_ / 2 : tile_;  // no thread waits long for the last one
}

/// Whether the noise of all samples of a range is prepared.
bool SampleSet::prepared(Range r) const noexcept {
  const auto first = prepared_.begin() + r.first / tile_,
             last = prepared_.begin() + (r.first + r.count - 1) / tile_;
  return std::find(first, last + 1, 0) == last + 1;
}

/// Calls `each(range, statistics)` for every part begun before the deadline, and combines the statistics.
template <class Each>
BatchStatistics SampleSet::run_parts(ThreadPool& pool, const Deadline& deadline, Each&& each) noexcept {
  const int size = part_size(pool.threads());
  const int parts = (values_.stride() + size - 1) / size;
  pool.run(parts, [&](int index) {
    BatchStatistics statistics;
    if (deadline.passed()) {
      skip(part(index, size), statistics);
    } else {
      each(part(index, size), statistics);
    }
    statistics_[index] = statistics;
  });
  BatchStatistics all;
  all.minimum_cost = all.minimum_total = infinite;
  int end = 0;
  for (int i = 0; i < parts; ++i) {
    all += statistics_[i];
    if (statistics_[i].evaluated > 0) end = std::min((i + 1) * size, values_.stride());
  }
  reached_ = (end + tile_ - 1) / tile_;
  std::fill(weights_.data() + end, weights_.data() + values_.stride(), 0.0f);
  return all;
}

void SampleSet::propose(const SequenceList& proposals) noexcept {
  proposals_ = proposals.values.data();
  proposed_ = std::min(proposals.sequences, samples());
}

/// Draws each range by `draw(range)` and evaluates it.
template <class Draw>
BatchStatistics SampleSet::draw_and_evaluate(const BatchEvaluator& evaluator, RandomKey key,
                                             const float* linear, ThreadPool& pool, const Deadline& deadline,
                                             Draw&& draw) noexcept {
  if (evaluator.sampler() || !prepared_for(key)) begin_prepare({});
  BatchStatistics statistics;
  if (evaluator.whole_batches()) {
    pool.run(tiles(), [&](int tile) { draw(range(tile)); });
    statistics = evaluate_whole(evaluator, linear, pool, deadline);
  } else {
    statistics = run_parts(pool, deadline, [&](Range r, BatchStatistics& of_part) {
      const auto start = Clock::now();
      draw(r);
      const auto drawn = Clock::now();
      finish(r, &evaluator, linear, of_part);
      of_part.draw_time = seconds(start, drawn);
      of_part.evaluate_time = seconds(drawn, Clock::now());
    });
  }
  begin_prepare({});
  return statistics;
}

BatchStatistics SampleSet::draw_and_evaluate(const BatchEvaluator& evaluator, RandomKey key,
                                             const SamplingDistribution& to, const float* linear,
                                             ThreadPool& pool, const Deadline& deadline,
                                             const SequenceList& known) noexcept {
  return draw_and_evaluate(evaluator, key, linear, pool, deadline, [&](Range r) {
    sample_range(evaluator.sampler(), key, to, known, prepared(r), r);
  });
}

BatchStatistics SampleSet::draw_and_evaluate(const BatchEvaluator& evaluator, RandomKey key,
                                             const Mixture& from, const SequenceList& known, ThreadPool& pool,
                                             const Deadline& deadline) noexcept {
  return draw_and_evaluate(evaluator, key, nullptr, pool, deadline, [&](Range r) {
    sample_range(evaluator.sampler(), key, from, known, prepared(r), r);
  });
}

/// Puts the proposals that fall into a range at the samples from `first` on.
void SampleSet::place_proposals(int first, const float* mean, const float* low, const float* high,
                                Range r) noexcept {
  const int end = std::min(first + proposed_, r.first + r.count);
  for (int k = std::max(first, r.first); k < end; ++k) {
    const float* proposal = proposals_ + static_cast<std::ptrdiff_t>(k - first) * rows();
    for (int row = 0; row < rows(); ++row) {
      const float value = std::isfinite(proposal[row]) ? proposal[row] : mean[row];
      values_[row][k] = std::clamp(value, low[row], high[row]);
    }
  }
}

/// Draws a range of samples of a mixture, from the prepared noise if `ready`.
void SampleSet::sample_range(const Sampler* sampler, RandomKey key, const Mixture& from,
                             const SequenceList& known, bool ready, Range r) noexcept {
  if (!ready) fill_noise(sampler, noise_, r, key);
  const Rows white = rows_of(noise_), shaped = shape_.correlated() ? row_view() : white;
  if (shape_.correlated()) {
    for (int row = 0; row < rows(); ++row)
      std::copy_n(white.row(row) + r.first, r.count, shaped.row(row) + r.first);
    shape_.apply(values_, r);
  }
  kernels::sample_mixture(white, shaped, row_view(), from, r);
  for (int k = r.first; k < std::min(known.sequences, r.first + r.count); ++k)
    values_.set_sample(k, known.values.subspan(static_cast<std::size_t>(k * rows())));
  place_proposals(known.sequences, from.sources[0].mean, from.low, from.high, r);
}

/// Draws a range of the samples, from the prepared noise if `ready`. Proposals take the places of the last
/// samples. A value that is not finite becomes that of the mean.
void SampleSet::sample_range(const Sampler* sampler, RandomKey key, const SamplingDistribution& to,
                             const SequenceList& known, bool ready, Range r) noexcept {
  if (!ready) fill_noise(sampler, values_, r, key);
  SequenceBatch& from = ready ? noise_ : values_;
  kernels::sample(rows_of(from), row_view(), to, r);
  place_proposals(samples() - proposed_, to.mean, to.low, to.high, r);
  for (int i = 0, k = samples() - proposed_ - 1; i < known.sequences && k >= r.first; ++i, --k)
    if (k < r.first + r.count)
      values_.set_sample(k, known.values.subspan(static_cast<std::size_t>(i * rows())));
}

void SampleSet::draw(RandomKey key, const SamplingDistribution& to, ThreadPool& pool) noexcept {
  pool.run(tiles(), [&](int tile) { sample_range(nullptr, key, to, {}, false, range(tile)); });
}

BatchStatistics SampleSet::evaluate_whole(const BatchEvaluator& evaluator, const float* linear,
                                          ThreadPool& pool, const Deadline& deadline) noexcept {
  const auto start = Clock::now();
  const bool late = deadline.passed();
  if (!late) evaluator.evaluate(values_, 0, samples(), costs_.data(), collided_.data());
  const double taken = seconds(start, Clock::now());
  BatchStatistics statistics = run_parts(pool, late ? Deadline(start, 0) : Deadline(),
                                         [&](Range r, BatchStatistics& s) { finish(r, nullptr, linear, s); });
  statistics.evaluate_time += taken;
  return statistics;
}

BatchStatistics SampleSet::evaluate(const BatchEvaluator& evaluator, const float* linear, ThreadPool& pool,
                                    const Deadline& deadline) noexcept {
  if (evaluator.whole_batches()) return evaluate_whole(evaluator, linear, pool, deadline);
  return run_parts(pool, deadline, [&](Range r, BatchStatistics& statistics) {
    const auto start = Clock::now();
    finish(r, &evaluator, linear, statistics);
    statistics.evaluate_time = seconds(start, Clock::now());
  });
}

void SampleSet::keep_terms(const float* linear, ThreadPool& pool) noexcept {
  pool.run(reached_, [&](int tile) {
    const Range r = range(tile);
    std::fill_n(terms_.data() + r.first, r.count, 0.0f);
    kernels::add_linear(row_view(), linear, r, terms_.data());
  });
}

float SampleSet::mix_totals(float factor, ThreadPool& pool) noexcept {
  pool.run(reached_, [&](int tile) {
    const Range r = range(tile);
    kernels::add_scaled(costs_.data(), factor, terms_.data(), r, totals_.data());
    kernels::make_finite(r, totals_.data());
    least_[tile] = kernels::minimum(totals_.data(), r);
  });
  return *std::min_element(least_.begin(), least_.begin() + std::max(reached_, 1));
}

WeightSums<double> SampleSet::weigh(float least, float temperature, ThreadPool& pool) noexcept {
  pool.run(reached_, [&](int tile) {
    weight_sums_[tile] = kernels::exponential_weights(totals_.data(), costs_.data(), least, temperature,
                                                      range(tile), weights_.data());
  });
  WeightSums<double> all;
  for (const WeightSums<float>& sums : std::span(weight_sums_).first(static_cast<std::size_t>(reached_))) {
    all.weight += sums.weight;
    all.squared += sums.squared;
    all.cost += sums.cost;
  }
  return all;
}

WeightSums<double> SampleSet::sum_weights(int count) const noexcept {
  WeightSums<double> all;
  for (int i = 0; i < count; ++i) {
    const double w = weights_[i];
    all.weight += w;
    all.squared += w * w;
    if (w > 0) all.cost += w * costs_[i];
  }
  return all;
}

/// Calls each(range, sums) for every tile, and adds the `count` sums of the tiles in their order.
template <class Each>
void SampleSet::add_tiles(int count, double* sums, ThreadPool& pool, Each&& each) noexcept {
  pool.run(reached_, [&](int tile) { each(range(tile), tile_sums_[tile]); });
  std::fill_n(sums, count, 0.0);
  for (int tile = 0; tile < reached_; ++tile)
    for (int i = 0; i < count; ++i) sums[i] += tile_sums_[tile][i];
}

void SampleSet::weighted_sums(const float* centre, double* sums, ThreadPool& pool, double factor) noexcept {
  add_tiles(rows(), sums, pool, [&](Range r, float* of_tile) {
    if (factor != 1) kernels::scale(static_cast<float>(factor), r, weights_.data());
    kernels::weighted_sums(row_view(), weights_.data(), centre, r, of_tile);
  });
}

void SampleSet::weighted_squares(const float* centre, double* sums, ThreadPool& pool) noexcept {
  add_tiles(rows(), sums, pool, [&](Range r, float* of_tile) {
    kernels::weighted_squares(row_view(), weights_.data(), centre, r, of_tile);
  });
}

void SampleSet::two_moments(const float* first, const float* second, const float* centre, double* sums,
                            ThreadPool& pool) noexcept {
  add_tiles(rows() * moments, sums, pool, [&](Range r, float* of_tile) {
    kernels::two_moments(row_view(), first, second, centre, r, of_tile);
  });
}

void bind_samples(const SampleSet& set, SolveResult& result) noexcept {
  result.samples = &set.values();
  result.costs = set.costs();
  result.collided = set.collided();
  result.weights = set.weights();
}

void report_samples(const SampleSet& set, const BatchStatistics& statistics, const WeightSums<double>& sums,
                    SolveResult& result) noexcept {
  bind_samples(set, result);
  result.minimum_cost = statistics.minimum_cost;
  result.expected_cost = sums.weight > 0 ? sums.cost / sums.weight : 0;
  result.effective_sample_size = sums.effective();
  result.collided_share =
      statistics.evaluated > 0 ? static_cast<double>(statistics.collided) / statistics.evaluated : 0;
}

}  // namespace slalom::detail
