#include "solvers/sampling/sample_report.hpp"

#include <algorithm>

namespace slalom::detail {

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
  result.effective_sample_size = sums.squared > 0 ? sums.weight * sums.weight / sums.squared : 0;
  const bool few = sums.squared > 0 && result.effective_sample_size < SolveResult::few_samples;
  // The count has a limit, so that it cannot overflow.
  result.few_samples_solves = few ? std::min(result.few_samples_solves + 1, 1'000'000) : 0;
  result.collided_share =
      statistics.evaluated > 0 ? static_cast<double>(statistics.collided) / statistics.evaluated : 0;
  result.times.draw += statistics.draw_time;
  result.times.evaluate += statistics.evaluate_time;
}

}  // namespace slalom::detail
