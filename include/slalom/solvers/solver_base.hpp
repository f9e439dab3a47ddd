#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/options.hpp"
#include "slalom/core/random.hpp"
#include "slalom/core/sequence_batch.hpp"
#include "slalom/core/thread_pool.hpp"
#include "slalom/solvers/solver.hpp"

/// The parts that solvers have in common. Your own can use them, as examples/predictive_sampling.hpp does.
namespace slalom {

/// The time at which a solve must end. A deadline without a limit never reads the clock.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;  ///< monotonic

  Deadline() = default;
  /// `allowed` seconds after `start`; infinite: no limit.
  Deadline(Clock::time_point start, double allowed);
  bool passed() const noexcept { return limited_ && Clock::now() >= end_; }  ///< whether the time is over
  /// Returns a deadline after the fraction `share` of the time.
  Deadline part(double share) const noexcept;

 private:
  Clock::time_point start_{}, end_{};
  bool limited_ = false;
};

/// The outcome of evaluating a batch.
struct BatchOutcome {
  int samples = 0;    ///< number in the batch
  int evaluated = 0;  ///< number evaluated before the deadline
  int finite = 0;     ///< number whose cost is finite
  int collided = 0;   ///< number that collide
  int best = 0;       ///< index of the sample of least cost, the first of equal ones

  /// `deadline` if samples were left out, `degenerate` without a finite cost, `all_collided`, or `ok`.
  Status status() const noexcept;
};

/// Dimensions, bounds, threads and random streams of a solver.
class SolverBase : public Solver {
 public:
  int horizon() const noexcept override { return horizon_; }
  int inputs() const noexcept override { return inputs_; }
  const SolveResult& result() const noexcept override { return result_; }

 protected:
  /// `Options` has the fields `horizon`, `input_min`, `input_max`, `seed` and `threads`. The solver starts
  /// its own threads unless a pool is given. If no float32 value lies within the bounds of an input, both
  /// become the nearest one. Throws std::invalid_argument if a lower bound is above the upper one, or if the
  /// magnitude of a finite bound exceeds 1e12.
  template <class Options>
  SolverBase(const Options& options, int inputs, std::shared_ptr<ThreadPool> pool)
      : SolverBase(options.horizon, inputs, options.input_min, options.input_max, options.seed,
                   pool ? std::move(pool) : std::make_shared<ThreadPool>(options.threads)) {
    if constexpr (requires { options.variance; }) {
      small_variance_ = true;
      for (int i = 0; i < inputs; ++i) {
        const double range = options.input_max[i] - options.input_min[i];
        small_variance_ =
            small_variance_ && 1e4 * options.variance[i] < range * range && std::isfinite(range);
      }
    }
  }

  int rows() const noexcept { return horizon_ * inputs_; }  ///< values of a control sequence
  std::size_t size() const noexcept {
    return static_cast<std::size_t>(rows());
  }                                               ///< `rows` as an unsigned number
  ThreadPool& pool() noexcept { return *pool_; }  ///< the threads that evaluate

  /// The random stream of a stage (< 65536) of the present solve.
  RandomKey key(int stage) const noexcept {
    return {seed_, (solves_ << 16) | static_cast<std::uint64_t>(stage)};
  }
  /// Looks for symptoms in `result_`, and counts a solve, so that the next one has other random numbers. Call
  /// it once per solve, at its end.
  void next_solve() noexcept {
    watch();
    ++solves_;
  }
  /// Restarts the random numbers from `seed`. Call it in `reset`.
  void restart(std::uint64_t seed) noexcept {
    seed_ = seed;
    solves_ = 0;
    steady_cost_ = highest_cost_ = swing_ = 0;
  }

  /// Returns one value for each row, [step][input], from one for each input.
  std::vector<float> spread(const PerInput& values) const;
  /// Lower bounds, [row].
  const std::vector<float>& low() const noexcept { return low_; }
  const std::vector<float>& high() const noexcept { return high_; }  ///< upper bounds, [row]
  /// Moves a control sequence [row] into the bounds.
  void clamp(float* sequence) const noexcept;
  /// Moves a control sequence [row] forward by `steps` >= 0, as `shift_sequence` does, in place.
  void move_forward(float* sequence, double steps) noexcept;

  /// Evaluates a batch on all threads, until the deadline. `costs` and `collided` have `batch.stride()`
  /// entries. Costs that are not finite, and those of samples that were not reached, become +infinity.
  BatchOutcome evaluate(const BatchEvaluator& evaluator, const SequenceBatch& batch, const Deadline& deadline,
                        float* costs, std::uint8_t* collided) noexcept;

  /// Makes the cheapest of the proposals, moved into the bounds, the inputs of the result if it costs less.
  void choose(const BatchEvaluator& evaluator, const SequenceList& proposals) noexcept;

  /// The first index of the samples that are drawn around zero, if they are the fraction `share` of all.
  static int zero_mean_from(int samples, double share) noexcept {
    return saturate_cast<int>((1.0 - share) * static_cast<double>(samples));
  }

  SolveResult result_;         ///< the last result; `clone` points its spans into the copy
  std::vector<float> chosen_;  ///< a proposal that cost less than the solution [row]

 private:
  SolverBase(int horizon, int inputs, const PerInput& input_min, const PerInput& input_max,
             std::uint64_t seed, std::shared_ptr<ThreadPool> pool);
  void watch() noexcept;
  bool samples_diverge() const noexcept;
  bool first_input_swings() noexcept;
  Symptom suspicion() noexcept;

  int horizon_;
  int inputs_;
  std::shared_ptr<ThreadPool> pool_;
  std::uint64_t seed_;
  std::uint64_t solves_ = 0;
  std::vector<float> low_, high_, moved_;  ///< [row]
  SequenceBatch compared_;                 ///< the solution and proposals
  bool small_variance_ = false;            ///< whether the deviations are below a hundredth of the ranges
  double steady_cost_ = 0;                 ///< least cost of the solve since which it has stayed the same
  double swing_ = 0;                       ///< mean |second difference| of the first input, in ranges
  double past_input_[2] = {};              ///< the first input of the last two solves
  double highest_cost_ = 0;                ///< highest least cost since the last reset
};

/// Moves a control sequence [step][input] forward by `shift` >= 0 steps, by linear interpolation, and holds
/// the last input. `sequence` and `result` must not overlap.
void shift_sequence(const float* sequence, int steps, int inputs, double shift, float* result) noexcept;
/// Shifts a sequence in double.
void shift_sequence(const double* sequence, int steps, int inputs, double shift, double* result) noexcept;

/// The time since the last solve in steps of the evaluator; 0 if the duration of a step is unknown.
double warm_start_shift(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept;

}  // namespace slalom
