#include "solvers/solver_base.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "slalom/core/option_access.hpp"

namespace slalom::detail {

namespace {

/// The float32 value next to `bound` that is not below (above) it.
float not_below(double bound) {
  const float f = static_cast<float>(bound);
  return static_cast<double>(f) < bound ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}
float not_above(double bound) {
  const float f = static_cast<float>(bound);
  return static_cast<double>(f) > bound ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

template <class Real>
void shift_rows(const Real* sequence, int steps, int inputs, double shift, Real* result) noexcept {
  const double last = steps - 1;
  for (int k = 0; k < steps; ++k) {
    const double at = std::min(k + shift, last);
    const int before = static_cast<int>(at);
    const int after = std::min(before + 1, steps - 1);
    const Real part = static_cast<Real>(at - before);
    for (int i = 0; i < inputs; ++i) {
      const Real a = sequence[before * inputs + i], b = sequence[after * inputs + i];
      result[k * inputs + i] = a + part * (b - a);
    }
  }
}

}  // namespace

SolverBase::SolverBase(int horizon, int inputs, const PerInput& input_min, const PerInput& input_max,
                       std::uint64_t seed, std::shared_ptr<ThreadPool> pool)
    : horizon_(horizon), inputs_(inputs), pool_(std::move(pool)), seed_(seed), low_(size()), high_(size()) {
  for (int r = 0; r < rows(); ++r) {
    const int input = r % inputs;
    const float low = not_below(input_min[input]), high = not_above(input_max[input]);
    if (!(low <= high)) {
      throw std::invalid_argument("input_min: " + to_text(input_min[input]) +
                                  " is above input_max: " + to_text(input_max[input]));
    }
    low_[static_cast<std::size_t>(r)] = low;
    high_[static_cast<std::size_t>(r)] = high;
  }
}

std::vector<float> SolverBase::spread(const PerInput& values) const {
  std::vector<float> rows_of(size());
  for (std::size_t r = 0; r < rows_of.size(); ++r) {
    rows_of[r] = static_cast<float>(values[static_cast<int>(r) % inputs_]);
  }
  return rows_of;
}

void SolverBase::clamp(float* sequence) const noexcept {
  for (std::size_t r = 0; r < size(); ++r) sequence[r] = std::clamp(sequence[r], low_[r], high_[r]);
}

void shift_sequence(const float* sequence, int steps, int inputs, double shift, float* result) noexcept {
  shift_rows(sequence, steps, inputs, shift, result);
}
void shift_sequence(const double* sequence, int steps, int inputs, double shift, double* result) noexcept {
  shift_rows(sequence, steps, inputs, shift, result);
}

double warm_start_shift(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept {
  const double step = evaluator.time_step();
  if (!(step > 0) || !(request.elapsed > 0)) return 0;
  return std::min(request.elapsed / step, 1e6);
}

void report_samples(const SampleSet& set, const BatchStatistics& statistics, const WeightSums<double>& sums,
                    SolveResult& result) noexcept {
  result.samples = &set.values();
  result.costs = set.costs();
  result.collided = set.collided();
  result.weights = set.weights();
  result.minimum_cost = static_cast<double>(statistics.minimum_cost);
  result.expected_cost = sums.weight > 0 ? sums.cost / sums.weight : 0;
  result.effective_sample_size = sums.squared > 0 ? sums.weight * sums.weight / sums.squared : 0;
  result.collided_share =
      statistics.evaluated > 0 ? static_cast<double>(statistics.collided) / statistics.evaluated : 0;
  result.times.draw += statistics.draw_time;
  result.times.evaluate += statistics.evaluate_time;
}

}  // namespace slalom::detail
