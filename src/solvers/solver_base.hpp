#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "slalom/core/options.hpp"
#include "slalom/core/thread_pool.hpp"
#include "slalom/solvers/solver.hpp"
#include "solvers/methods/control_term.hpp"
#include "solvers/sampling/sample_set.hpp"

namespace slalom::detail {

/// What all solvers have: dimensions, bounds, threads, random streams, the solution that is carried from one
/// solve to the next.
class SolverBase : public Solver {
 public:
  int horizon() const noexcept override { return horizon_; }
  int inputs() const noexcept override { return inputs_; }

 protected:
  /// `Options` has the fields of every method's options. Throws std::invalid_argument on bounds that hold no
  /// finite value.
  template <class Options>
  SolverBase(const Options& options, int inputs, std::shared_ptr<ThreadPool> pool)
      : SolverBase(options.horizon, inputs, options.input_min, options.input_max, options.seed,
                   pool ? std::move(pool) : std::make_shared<ThreadPool>(options.threads)) {}

  int rows() const noexcept { return horizon_ * inputs_; }
  std::size_t size() const noexcept { return static_cast<std::size_t>(rows()); }
  ThreadPool& pool() noexcept { return *pool_; }

  /// The random stream of a stage (< 65536) of the present solve.
  RandomKey key(int stage) const noexcept {
    return {seed_, (solves_ << 16) | static_cast<std::uint64_t>(stage)};
  }
  void next_solve() noexcept { ++solves_; }
  void restart(std::uint64_t seed) noexcept {
    seed_ = seed;
    solves_ = 0;
  }

  /// A value per row from one per input.
  std::vector<float> spread(const PerInput& values) const;
  const std::vector<float>& low() const noexcept { return low_; }
  const std::vector<float>& high() const noexcept { return high_; }
  void clamp(float* sequence) const noexcept;

  /// The first index of the samples that are drawn around zero.
  static int zero_mean_from(int samples, double share) noexcept {
    return static_cast<int>((1.0 - share) * static_cast<double>(samples));
  }

 private:
  SolverBase(int horizon, int inputs, const PerInput& input_min, const PerInput& input_max,
             std::uint64_t seed, std::shared_ptr<ThreadPool> pool);

  int horizon_;
  int inputs_;
  std::shared_ptr<ThreadPool> pool_;
  std::uint64_t seed_;
  std::uint64_t solves_ = 0;
  std::vector<float> low_, high_;  ///< [row]
};

/// A control sequence [step][input] moved forward by `shift` >= 0 steps, by linear interpolation; the last
/// input is held. `sequence` and `result` may not overlap.
void shift_sequence(const float* sequence, int steps, int inputs, double shift, float* result) noexcept;
void shift_sequence(const double* sequence, int steps, int inputs, double shift, double* result) noexcept;

/// The shift, in steps, that the time between two solves asks for; 0 where it is not known.
double warm_start_shift(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept;

/// Puts what the samples of `set` tell into a result.
void report_samples(const SampleSet& set, const BatchStatistics& statistics, const WeightSums<double>& sums,
                    SolveResult& result) noexcept;

}  // namespace slalom::detail
