#include "solvers/sampling/sample_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slalom::detail {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// Samples a tile: their values fill about 32 KiB, and rollouts take four packs of them at a time.
int tile_size(int rows) {
  constexpr int together = 4 * simd::padding;
  const int fitting = 32768 / (4 * std::max(rows, 1)) / together * together;
  return std::clamp(fitting, together, 512);
}

}  // namespace

SampleSet::SampleSet(int steps, int inputs, int samples, NoiseShape shape)
    : values_(steps, inputs, samples),
      noise_(steps, inputs, samples),
      shape_(std::move(shape)),
      costs_(static_cast<std::size_t>(padded(samples))),
      totals_(static_cast<std::size_t>(padded(samples))),
      weights_(static_cast<std::size_t>(padded(samples))),
      terms_(static_cast<std::size_t>(padded(samples))),
      collided_(static_cast<std::size_t>(padded(samples))),
      tile_(tile_size(steps * inputs)),
      statistics_(static_cast<std::size_t>(tiles())),
      weight_sums_(static_cast<std::size_t>(tiles())),
      least_(static_cast<std::size_t>(tiles())),
      row_sums_(static_cast<std::size_t>(tiles()) * static_cast<std::size_t>(steps * inputs)),
      moment_sums_(row_sums_.size() * moments) {}

Range SampleSet::range(int tile) const noexcept {
  const int first = tile * tile_;
  return {first, std::min(tile_, values_.stride() - first)};
}

/// Noise from the problem's sampler, or normal values where it has none, in its shape.
void SampleSet::fill_noise(const Sampler* sampler, SequenceBatch& to, Range r, RandomKey key) noexcept {
  if (sampler) {
    sampler->fill(to, r.first, r.count, key);
  } else {
    fill_normal(to, r.first, r.count, key);
  }
  if (!shape_.plain()) shape_.apply(to, r, key);
}

void SampleSet::prepare(RandomKey key, ThreadPool& pool) noexcept {
  pool.run(tiles(), [&](int tile) { fill_noise(nullptr, noise_, range(tile), key); });
  prepared_ = true;
  prepared_key_ = key;
}

/// Brings the costs of a tile, evaluated here or before, in order: infinite where not finite and in the
/// padding.
void SampleSet::finish_tile(int tile, const BatchEvaluator* evaluator, const float* linear,
                            BatchStatistics& statistics) noexcept {
  const Range r = range(tile);
  const int count = std::min(r.count, samples() - r.first);
  if (evaluator) evaluator->evaluate(values_, r.first, count, costs_.data(), collided_.data());
  for (int i = r.first + count; i < r.first + r.count; ++i) {
    costs_[static_cast<std::size_t>(i)] = infinite;
    collided_[static_cast<std::size_t>(i)] = 0;
  }
  const CostStatistics<float> found = kernels().finish(row_view(), linear, r, costs_.data(), totals_.data());
  statistics.minimum_cost = found.least_cost;
  statistics.minimum_total = found.least_total;
  statistics.finite = found.finite;
  statistics.evaluated = count;
  const std::uint8_t* hit = collided_.data() + r.first;
  statistics.collided =
      static_cast<int>(std::count_if(hit, hit + count, [](std::uint8_t h) { return h != 0; }));
}

void SampleSet::skip_tile(int tile, BatchStatistics& statistics) noexcept {
  const Range r = range(tile);
  std::fill_n(costs_.data() + r.first, r.count, infinite);
  std::fill_n(totals_.data() + r.first, r.count, infinite);
  std::fill_n(collided_.data() + r.first, r.count, std::uint8_t{0});
  statistics.minimum_cost = statistics.minimum_total = infinite;
}

BatchStatistics SampleSet::combine() const noexcept {
  BatchStatistics all;
  all.minimum_cost = all.minimum_total = infinite;
  for (const BatchStatistics& c : statistics_) {
    all.minimum_total = std::min(all.minimum_total, c.minimum_total);
    all.minimum_cost = std::min(all.minimum_cost, c.minimum_cost);
    all.finite += c.finite;
    all.collided += c.collided;
    all.evaluated += c.evaluated;
    all.draw_time += c.draw_time;
    all.evaluate_time += c.evaluate_time;
  }
  return all;
}

BatchStatistics SampleSet::draw_and_evaluate(const BatchEvaluator& evaluator, RandomKey key,
                                             const SamplingDistribution<float>& to, const float* linear,
                                             ThreadPool& pool, const Deadline& deadline) noexcept {
  const Sampler* const sampler = evaluator.sampler();
  const bool ready =
      !sampler && prepared_ && prepared_key_.seed == key.seed && prepared_key_.stream == key.stream;
  prepared_ = false;
  if (evaluator.whole_batches()) {
    place(sampler, key, to, ready, pool);
    return evaluate_whole(evaluator, linear, pool, deadline);
  }
  pool.run(tiles(), [&](int tile) {
    BatchStatistics statistics;
    if (deadline.passed()) {
      skip_tile(tile, statistics);
    } else {
      const auto start = Clock::now();
      const Range r = range(tile);
      if (!ready) fill_noise(sampler, values_, r, key);
      SequenceBatch& from = ready ? noise_ : values_;
      kernels().sample({from.row(0, 0), from.stride(), rows()}, row_view(), to, r);
      const auto drawn = Clock::now();
      finish_tile(tile, &evaluator, linear, statistics);
      statistics.draw_time = seconds(start, drawn);
      statistics.evaluate_time = seconds(drawn, Clock::now());
    }
    statistics_[static_cast<std::size_t>(tile)] = statistics;
  });
  return combine();
}

/// Draws, or takes the noise that is ready, and puts it in its place.
void SampleSet::place(const Sampler* sampler, RandomKey key, const SamplingDistribution<float>& to,
                      bool ready, ThreadPool& pool) noexcept {
  pool.run(tiles(), [&](int tile) {
    const Range r = range(tile);
    if (!ready) fill_noise(sampler, values_, r, key);
    SequenceBatch& from = ready ? noise_ : values_;
    kernels().sample({from.row(0, 0), from.stride(), rows()}, row_view(), to, r);
  });
}

void SampleSet::draw(RandomKey key, const SamplingDistribution<float>& to, ThreadPool& pool) noexcept {
  place(nullptr, key, to, false, pool);
}

BatchStatistics SampleSet::evaluate_whole(const BatchEvaluator& evaluator, const float* linear,
                                          ThreadPool& pool, const Deadline& deadline) noexcept {
  const auto start = Clock::now();
  const bool late = deadline.passed();
  if (!late) evaluator.evaluate(values_, 0, samples(), costs_.data(), collided_.data());
  const double taken = seconds(start, Clock::now());
  pool.run(tiles(), [&](int tile) {
    BatchStatistics statistics;
    if (late) {
      skip_tile(tile, statistics);
    } else {
      finish_tile(tile, nullptr, linear, statistics);
    }
    if (tile == 0) statistics.evaluate_time = taken;
    statistics_[static_cast<std::size_t>(tile)] = statistics;
  });
  return combine();
}

BatchStatistics SampleSet::evaluate(const BatchEvaluator& evaluator, const float* linear, ThreadPool& pool,
                                    const Deadline& deadline) noexcept {
  if (evaluator.whole_batches()) return evaluate_whole(evaluator, linear, pool, deadline);
  pool.run(tiles(), [&](int tile) {
    BatchStatistics statistics;
    if (deadline.passed()) {
      skip_tile(tile, statistics);
    } else {
      const auto start = Clock::now();
      finish_tile(tile, &evaluator, linear, statistics);
      statistics.evaluate_time = seconds(start, Clock::now());
    }
    statistics_[static_cast<std::size_t>(tile)] = statistics;
  });
  return combine();
}

void SampleSet::keep_terms(const float* linear, ThreadPool& pool) noexcept {
  pool.run(tiles(), [&](int tile) {
    const Range r = range(tile);
    std::fill_n(terms_.data() + r.first, r.count, 0.0f);
    kernels().add_linear(row_view(), linear, r, terms_.data());
  });
}

float SampleSet::mix_totals(float factor, ThreadPool& pool) noexcept {
  pool.run(tiles(), [&](int tile) {
    const Range r = range(tile);
    kernels().add_scaled(costs_.data(), factor, terms_.data(), r, totals_.data());
    kernels().make_finite(r, totals_.data());
    least_[static_cast<std::size_t>(tile)] = kernels().minimum(totals_.data(), r);
  });
  return *std::min_element(least_.begin(), least_.end());
}

WeightSums<double> SampleSet::weigh(float least, float temperature, ThreadPool& pool, float index) noexcept {
  const Kernels<float>& k = kernels();
  pool.run(tiles(), [&](int tile) {
    WeightSums<float>& sums = weight_sums_[static_cast<std::size_t>(tile)];
    const float *totals = totals_.data(), *costs = costs_.data();
    sums = index == 1
               ? k.exponential_weights(totals, costs, least, temperature, range(tile), weights_.data())
               : k.tsallis_weights(totals, costs, least, temperature, index, range(tile), weights_.data());
  });
  WeightSums<double> all;
  for (const WeightSums<float>& sums : weight_sums_) {
    all.weight += static_cast<double>(sums.weight);
    all.squared += static_cast<double>(sums.squared);
    all.cost += static_cast<double>(sums.cost);
  }
  return all;
}

WeightSums<double> SampleSet::sum_weights() const noexcept {
  WeightSums<double> all;
  for (std::size_t i = 0; i < count(); ++i) {
    const double w = static_cast<double>(weights_[i]);
    all.weight += w;
    all.squared += w * w;
    if (w > 0) all.cost += w * static_cast<double>(costs_[i]);
  }
  return all;
}

void SampleSet::scale_weights(double factor) noexcept {
  kernels().scale(static_cast<float>(factor), {0, values_.stride()}, weights_.data());
}

void SampleSet::sum_rows(RowSums kernel, const float* centre, double* sums, ThreadPool& pool) noexcept {
  const auto n = static_cast<std::size_t>(rows());
  pool.run(tiles(), [&](int tile) {
    kernel(row_view(), weights_.data(), centre, range(tile), &row_sums_[static_cast<std::size_t>(tile) * n]);
  });
  std::fill_n(sums, n, 0.0);
  for (std::size_t tile = 0; tile < static_cast<std::size_t>(tiles()); ++tile)
    for (std::size_t r = 0; r < n; ++r) sums[r] += static_cast<double>(row_sums_[tile * n + r]);
}

void SampleSet::weighted_sums(const float* centre, double* sums, ThreadPool& pool) noexcept {
  sum_rows(kernels().weighted_sums, centre, sums, pool);
}

void SampleSet::weighted_squares(const float* centre, double* sums, ThreadPool& pool) noexcept {
  sum_rows(kernels().weighted_squares, centre, sums, pool);
}

void SampleSet::two_moments(const float* first, const float* second, const float* centre, double* sums,
                            ThreadPool& pool) noexcept {
  const std::size_t n = static_cast<std::size_t>(rows()) * moments;
  pool.run(tiles(), [&](int tile) {
    kernels().two_moments(row_view(), first, second, centre, range(tile),
                          &moment_sums_[static_cast<std::size_t>(tile) * n]);
  });
  std::fill_n(sums, n, 0.0);
  for (std::size_t tile = 0; tile < static_cast<std::size_t>(tiles()); ++tile)
    for (std::size_t i = 0; i < n; ++i) sums[i] += static_cast<double>(moment_sums_[tile * n + i]);
}

}  // namespace slalom::detail
