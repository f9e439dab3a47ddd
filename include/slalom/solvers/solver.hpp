#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/status.hpp"

namespace slalom {

class ThreadPool;

/// One control sequence after another, [sequence][step][input].
struct SequenceList {
  std::span<const float> values;  ///< [sequence][step][input]
  int sequences = 0;              ///< number
};

/// The inputs of a solve that change from one to the next.
struct SolveRequest {
  /// Time since the last solve, s; the warm start is shifted by it where the solver shifts.
  double elapsed = 0;
  /// Time the solve may take, s of wall clock from the call; from 1e6 s on there is no limit. After it no new
  /// part of the samples is begun, and what is best so far is returned. What is under way then (with an
  /// evaluator of `whole_batches` a whole batch), and the last update and check, may take longer.
  double deadline = std::numeric_limits<double>::infinity();
  /// Control sequences of other controllers that compete with the samples of this solve (proposals.hpp), over
  /// the solver's horizon. Values outside the bounds are moved into them. Only for a solver that
  /// `takes_proposals`; others ignore them.
  SequenceList proposals{};
};

/// Wall-clock times of the stages of one solve, s.
struct StageTimes {
  double draw = 0;      ///< drawing samples
  double evaluate = 0;  ///< rollouts of the samples
  double guide = 0;     ///< moving guide particles or iterating on the distribution
  double update = 0;    ///< weights, means, covariances
  double total = 0;     ///< whole solve, s
};

/// The outcome of a solve. Its spans point into the solver and stay valid until the next solve or reset.
struct SolveResult {
  /// Effective sample size below which a plan is hardly more than the best sample.
  static constexpr double few_samples = 3;
  /// Solves in a row with few samples after which `has_few_samples` reports it.
  static constexpr int few_samples_patience = 20;

  Status status = Status::ok;        ///< how the solve ended
  std::span<const float> inputs;     ///< the control sequence to apply, [step][input]
  std::span<const float> nominal;    ///< the nominal sequence (svg_mppi: the best guide), [step][input]
  std::span<const float> mean;       ///< mean of the resulting distribution, [step][input]
  std::span<const float> variances;  ///< variances of the distribution, [step][input]

  const SequenceBatch* samples = nullptr;  ///< samples that were drawn last
  std::span<const float> costs;            ///< costs of the samples
  std::span<const std::uint8_t> collided;  ///< 1 where a sample collides
  std::span<const float> weights;          ///< weights of the samples; the sum is 1, or less with a
                                           ///< `normaliser_offset`. If no cost is finite they mean nothing

  SequenceList guides;               ///< last positions of the guide particles (empty without guides)
  SequenceList guide_path;           ///< all guides after each transport step, [iteration x guide]
  double minimum_cost = 0;           ///< the least cost of a sample
  double expected_cost = 0;          ///< weighted mean of the samples' costs
  double effective_sample_size = 0;  ///< 1 / sum of squared weights
  int few_samples_solves = 0;        ///< solves in a row, with this one, below `few_samples`
  double collided_share = 0;         ///< share of the samples that collide, 0 ... 1
  double temperature = 0;            ///< lambda in use; 0 with `cem` and `icem`, which have none
  int iterations = 0;                ///< guide or distribution updates made
  StageTimes times;                  ///< times of the stages
  int gradient_kinks = 0;            ///< exact gradients of guides that were taken at a kink, or not finite

  /// Whether the effective sample size stays below `few_samples`: the plans then follow single samples. A
  /// larger temperature, smaller variances or `target_ess_fraction` raise it.
  bool has_few_samples() const noexcept { return few_samples_solves >= few_samples_patience; }
};

/// A method that solves any problem behind the seam of `BatchEvaluator`. After construction nothing here
/// allocates or throws; the same seed gives the same bits on any number of threads.
class Solver {
 public:
  virtual ~Solver() = default;

  /// The method's name, as configurations and results write it: "svg_mppi", ...
  virtual const char* name() const noexcept = 0;
  virtual int horizon() const noexcept = 0;  ///< steps
  /// Number of inputs of a step.
  virtual int inputs() const noexcept = 0;

  /// Whether the inputs of every result are within the bounds. False only for `sv_mpc` as published, whose
  /// program does not clamp its inputs (`PublishedSvMpc::clamp_solution`).
  virtual bool keeps_bounds() const noexcept { return true; }

  /// Whether `solve` uses the proposals of a request.
  virtual bool takes_proposals() const noexcept { return false; }

  /// A copy that goes on with the same bits: with the same requests from the same states both give the same
  /// results. Its last result points into the copy. The two share their threads; see ThreadPool.
  virtual std::unique_ptr<Solver> clone() const = 0;

  /// The result of the last solve, or the state after the last reset.
  virtual const SolveResult& result() const noexcept = 0;

  /// Solves from the evaluator's current state. Whatever happens, the result's inputs are finite and, if the
  /// solver `keeps_bounds`, within the bounds.
  virtual const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept = 0;

  /// Forgets the last solution and all other state, and restarts the random numbers from `seed`.
  virtual void reset(std::uint64_t seed) noexcept = 0;

  /// Draws the noise of the next solve ahead, so that it costs nothing inside the deadline; the results do
  /// not change. `mppi`, `svg_mppi` and `dial_mpc` (for its first update) do so; with the other methods, and
  /// where the evaluator has a `Sampler`, it has no effect.
  virtual void prepare() noexcept {}

  /// Allocates the memory that an evaluator needs besides that for costs, for instance for exact gradients.
  /// To be called before the first solve with it; a controller does so when it is made. The solver must not
  /// keep a reference to the evaluator. Throws std::invalid_argument that names an option that the evaluator
  /// cannot fulfil.
  virtual void connect(const BatchEvaluator& /*evaluator*/) {}
};

}  // namespace slalom
