#include "slalom/solvers/solver_base.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "slalom/core/option_access.hpp"
#include "slalom/solvers/option_groups.hpp"

namespace slalom {

namespace {

/// The nearest float32 value that is not below `bound`.
float not_below(double bound) {
  const float f = static_cast<float>(bound);
  return f < bound ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}
/// The nearest float32 value that is not above `bound`.
float not_above(double bound) {
  const float f = static_cast<float>(bound);
  return f > bound ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

/// Throws unless `bound` is `none`, or finite and so small that sums of its squares do not overflow.
void require_bound(const char* option, double bound, double none) {
  if (bound == none || std::abs(bound) <= detail::finite) return;
  throw std::invalid_argument(std::string(option) + ": " + to_text(bound) + " must be in [-1e12, 1e12], or " +
                              (none < 0 ? "-inf" : "inf") + " where there is no bound");
}

/// Marks the first sample of an evaluated tile, in addition to its collision flag.
constexpr std::uint8_t evaluated_mark = 2;

template <class Real>
void shift_rows(const Real* sequence, int steps, int inputs, double shift, Real* result) noexcept {
  const double last = steps - 1;
  for (int k = 0; k < steps; ++k) {
    const double at = std::min(k + shift, last);
    const int before = saturate_cast<int>(at);
    const int after = std::min(before + 1, steps - 1);
    const Real part = static_cast<Real>(at - before);
    for (int i = 0; i < inputs; ++i) {
      const Real a = sequence[before * inputs + i], b = sequence[after * inputs + i];
      result[k * inputs + i] = a + part * (b - a);
    }
  }
}

}  // namespace

Deadline::Deadline(Clock::time_point start, double allowed) : start_(start) {
  limited_ = allowed < 1e6;
  if (limited_) {
    end_ = start +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::max(allowed, 0.0)));
  }
}

Deadline Deadline::part(double share) const noexcept {
  Deadline result = *this;
  if (limited_) {
    result.end_ = start_ + std::chrono::duration_cast<Clock::duration>(share * (end_ - start_));
  }
  return result;
}

Status BatchOutcome::status() const noexcept {
  if (evaluated < samples) return Status::deadline;
  if (finite == 0) return Status::degenerate;
  return collided == samples ? Status::all_collided : Status::ok;
}

SolverBase::SolverBase(int horizon, int inputs, const PerInput& input_min, const PerInput& input_max,
                       std::uint64_t seed, std::shared_ptr<ThreadPool> pool)
    : chosen_(static_cast<std::size_t>(horizon) * static_cast<std::size_t>(inputs)),
      horizon_(horizon),
      inputs_(inputs),
      pool_(std::move(pool)),
      seed_(seed),
      low_(size()),
      high_(size()),
      moved_(size()),
      compared_(horizon, inputs, simd::padding) {
  for (int r = 0; r < rows(); ++r) {
    const int input = r % inputs;
    require_bound("input_min", input_min[input], -std::numeric_limits<double>::infinity());
    require_bound("input_max", input_max[input], std::numeric_limits<double>::infinity());
    float low = not_below(input_min[input]), high = not_above(input_max[input]);
    if (low > high && input_min[input] <= input_max[input])  // equal bounds between two float32 values
      low = high = static_cast<float>(input_min[input]);
    if (!(low <= high)) {
      throw std::invalid_argument("input_min: " + to_text(input_min[input]) + " must be at most input_max, " +
                                  to_text(input_max[input]));
    }
    low_[r] = low;
    high_[r] = high;
  }
}

std::vector<float> SolverBase::spread(const PerInput& values) const {
  std::vector<float> sequence(size());
  for (int r = 0; r < rows(); ++r) sequence[r] = static_cast<float>(values[r % inputs_]);
  return sequence;
}

void SolverBase::clamp(float* sequence) const noexcept {
  for (std::size_t r = 0; r < size(); ++r) sequence[r] = std::clamp(sequence[r], low_[r], high_[r]);
}

void SolverBase::move_forward(float* sequence, double steps) noexcept {
  shift_rows(sequence, horizon_, inputs_, steps, moved_.data());
  std::copy(moved_.begin(), moved_.end(), sequence);
}

BatchOutcome SolverBase::evaluate(const BatchEvaluator& evaluator, const SequenceBatch& batch,
                                  const Deadline& deadline, float* costs, std::uint8_t* collided) noexcept {
  constexpr float infinite = std::numeric_limits<float>::infinity();
  std::fill_n(costs, batch.stride(), infinite);
  std::fill_n(collided, batch.stride(), std::uint8_t{0});
  const int tile = evaluator.whole_batches() ? batch.stride() : 16 * simd::padding;
  pool_->run((batch.stride() + tile - 1) / tile, [&](int t) {
    if (deadline.passed()) return;
    evaluator.evaluate(batch, t * tile, std::min(tile, batch.samples() - t * tile), costs, collided);
    collided[t * tile] |= evaluated_mark;
  });
  BatchOutcome outcome{.samples = batch.samples()};
  for (int k = 0; k < batch.samples(); ++k) {
    if (k % tile == 0 && (collided[k] & evaluated_mark) != 0) {
      collided[k] &= static_cast<std::uint8_t>(~evaluated_mark);
      outcome.evaluated += std::min(tile, batch.samples() - k);
    }
    if (!std::isfinite(costs[k])) costs[k] = infinite;
    outcome.finite += costs[k] < infinite;
    outcome.collided += collided[k] != 0;
    if (costs[k] < costs[outcome.best]) outcome.best = k;
  }
  return outcome;
}

void SolverBase::choose(const BatchEvaluator& evaluator, const SequenceList& proposals) noexcept {
  float costs[simd::padding];
  std::uint8_t collided[simd::padding];
  for (int first = 0; first < proposals.sequences; first += simd::padding - 1) {
    const int count = std::min(proposals.sequences - first, simd::padding - 1);
    compared_.set_samples(count + 1);
    compared_.set_sample(0, result_.inputs);
    for (int k = 0; k < count; ++k) {
      const float* const proposal =
          proposals.values.data() + (first + k) * static_cast<std::ptrdiff_t>(size());
      for (int r = 0; r < rows(); ++r) {
        const std::size_t row = static_cast<std::size_t>(r);
        const float value = std::isfinite(proposal[r]) ? proposal[r] : result_.inputs[row];
        compared_[r][static_cast<std::size_t>(k) + 1] = std::clamp(value, low_[row], high_[row]);
      }
    }
    const BatchOutcome outcome = evaluate(evaluator, compared_, {}, costs, collided);
    if (outcome.best == 0) continue;
    compared_.get_sample(outcome.best, chosen_);
    result_.inputs = chosen_;
  }
}

void SolverBase::watch() noexcept {
  const Symptom found = suspicion();
  const bool again = found == result_.suspicion && found != Symptom::none;
  // The count has a limit, so that it cannot overflow.
  result_.suspicious_solves =
      again ? std::min(result_.suspicious_solves + 1, 1'000'000) : found != Symptom::none;
  result_.suspicion = found;
}

bool SolverBase::samples_diverge() const noexcept {
  const double far = highest_cost_ > 0 ? 1e9 * highest_cost_ : std::numeric_limits<double>::infinity();
  const auto diverged = std::count_if(result_.costs.begin(), result_.costs.end(), [&](float cost) {
    return !std::isfinite(cost) || static_cast<double>(cost) > far;
  });
  return 2 * static_cast<std::size_t>(diverged) > result_.costs.size();
}

bool SolverBase::first_input_swings() noexcept {
  constexpr double rate = 0.1;  ///< weight of a solve
  const double first = static_cast<double>(result_.inputs[0]);
  const double range = static_cast<double>(high_[0] - low_[0]);
  const double difference = std::abs(first - 2 * past_input_[0] + past_input_[1]);
  if (std::isfinite(range) && range > 0) swing_ += rate * (difference / range - swing_);
  past_input_[1] = std::exchange(past_input_[0], first);
  return swing_ > 0.2;
}

/// The first symptom of which the present result has the sign.
Symptom SolverBase::suspicion() noexcept {
  if (result_.status == Status::degenerate || result_.costs.empty()) return Symptom::none;
  const double least = result_.minimum_cost, effective = result_.effective_sample_size;
  const bool steady = std::abs(least - steady_cost_) <= 0.02 * std::abs(steady_cost_);
  if (!steady) steady_cost_ = least;
  highest_cost_ = std::max(highest_cost_, least);
  if (samples_diverge()) return Symptom::samples_diverge;
  const bool swings = first_input_swings();
  if (result_.temperature > 0 && effective < 3) return Symptom::few_samples;

  const double rounding = std::numeric_limits<float>::epsilon() * std::abs(least);
  const bool equal_costs = std::none_of(result_.costs.begin(), result_.costs.end(), [&](float cost) {
    return std::isfinite(cost) && cost - least > rounding;
  });
  const bool equal_weights =
      result_.temperature > 0 && effective > 0.9 * static_cast<double>(result_.costs.size());
  if (equal_costs || equal_weights) return Symptom::equal_costs;
  if (small_variance_) return Symptom::small_variance;

  int saturated = 0;
  for (std::size_t r = 0; r < size(); ++r) {
    const float range = high_[r] - low_[r], value = result_.inputs[r];
    saturated += std::isfinite(range) && std::min(value - low_[r], high_[r] - value) <= 0.1f * range;
  }
  if (10 * saturated >= 9 * rows()) return Symptom::saturated_inputs;
  if (swings) return Symptom::noisy_plan;
  return steady && 4 * least > highest_cost_ ? Symptom::no_progress : Symptom::none;
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

}  // namespace slalom
