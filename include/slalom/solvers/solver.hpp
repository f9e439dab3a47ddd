#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "slalom/core/batch_evaluator.hpp"
#include "slalom/core/status.hpp"
#include "slalom/solvers/symptom.hpp"

namespace slalom {

class ThreadPool;

/// A list of control sequences.
struct SequenceList {
  std::span<const float> values;  ///< [sequence][step][input]
  int sequences = 0;              ///< number of sequences
};

/// States near the present one, in which the robot may really be: each differs from it as an earlier
/// prediction differed from the state that came.
class NearbyStates {
 public:
  virtual ~NearbyStates() = default;
  virtual int count() const noexcept = 0;  ///< 0 while all predictions were exact
  /// Makes the evaluator start at one of them, or at the present state (-1).
  virtual void start_at(int index) noexcept = 0;
};

/// The inputs of a solve that change from one to the next.
struct SolveRequest {
  /// Time since the last solve, s, at least 0. Solvers that shift their warm start shift it by this time.
  double elapsed = 0;
  /// Wall-clock time that the solve may take, s; 1e6 or more: no limit. When it has passed, the solver begins
  /// no new part of the samples and returns the best solution so far. It ends later by the part that is being
  /// evaluated (with `whole_batches` the whole batch). A solver learns from late solves, whose status is
  /// `deadline`, how much time to keep for the last update and check, at most 0.8 of what it has.
  double deadline = std::numeric_limits<double>::infinity();
  /// Control sequences of other controllers that compete with the samples of this solve (proposals.hpp), over
  /// the solver's horizon. Values outside the bounds are moved into them. Solvers without `takes_proposals`
  /// ignore them.
  SequenceList proposals{};
  /// States near the present one, from which `svg_mppi` evaluates its plans, too. Controllers set it.
  NearbyStates* nearby = nullptr;
};

/// Whether a controller can solve a request for a problem whose steps take `time_step` (s; 0: unknown):
/// `elapsed` is finite, at least 0, and 0 if the duration of a step is unknown; the deadline is a number.
inline bool valid_times(const SolveRequest& request, double time_step) noexcept {
  const double most = time_step > 0 ? std::numeric_limits<double>::max() : 0;
  return request.elapsed >= 0 && request.elapsed <= most && request.deadline == request.deadline;
}

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
  /// Number of solves in a row with the same suspicion after which it is a symptom.
  static constexpr int symptom_patience = 20;

  Status status = Status::ok;        ///< how the solve ended
  std::span<const float> inputs;     ///< the control sequence to apply, [step][input]
  std::span<const float> nominal;    ///< the nominal sequence (svg_mppi: the best guide), [step][input]
  std::span<const float> mean;       ///< mean of the resulting distribution, [step][input]
  std::span<const float> variances;  ///< variances of the distribution, [step][input]

  const SequenceBatch* samples = nullptr;  ///< samples that were drawn last
  std::span<const float> costs;            ///< costs of the samples
  std::span<const std::uint8_t> collided;  ///< 1 where a sample collides
  std::span<const float> weights;          ///< weights of the samples; the sum is 1, or less with a
                                           ///< `normaliser_offset`. Meaningless if no cost is finite

  SequenceList guides;                ///< last positions of the guide particles (empty without guides)
  SequenceList guide_path;            ///< all guides after each transport step, [iteration x guide]
  double minimum_cost = 0;            ///< the least cost of a sample
  double expected_cost = 0;           ///< weighted mean of the samples' costs
  double effective_sample_size = 0;   ///< 1 / sum of squared weights
  double collided_share = 0;          ///< share of the samples that collide, 0 ... 1
  double temperature = 0;             ///< lambda in use; 0 with `cem` and `icem`, which have none
  int iterations = 0;                 ///< guide or distribution updates made
  int rollouts = 0;                   ///< control sequences evaluated, those of guides and choices included
  Symptom suspicion = Symptom::none;  ///< the first symptom of which this solve has the sign
  int suspicious_solves = 0;          ///< solves in a row with this suspicion, this one included
  StageTimes times;                   ///< times of the stages

  /// The likely reason for poor plans: a suspicion that stays. `explanation` says it in words.
  Symptom symptom() const noexcept {
    return suspicious_solves >= symptom_patience ? suspicion : Symptom::none;
  }
};

/// A method that solves any problem through the interface `BatchEvaluator`. `solve`, `reset` and `prepare` do
/// not allocate or throw. The same seed gives the same bits on any number of threads.
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

  /// Returns a copy that continues bit for bit like the original: the same requests from the same states give
  /// the same results. The last result of the copy points into the copy. Both share threads; see ThreadPool.
  virtual std::unique_ptr<Solver> clone() const = 0;

  /// The result of the last solve, or the state after the last reset.
  virtual const SolveResult& result() const noexcept = 0;

  /// Solves from the evaluator's current state. The result's inputs are always finite and, if the solver
  /// `keeps_bounds`, within the bounds.
  virtual const SolveResult& solve(const BatchEvaluator& evaluator, const SolveRequest& request) noexcept = 0;

  /// Forgets the last solution and all other state, and restarts the random numbers from `seed`.
  virtual void reset(std::uint64_t seed) noexcept = 0;

  /// Draws the noise of the next solve ahead of time, outside its deadline. The results do not change. Only
  /// `mppi`, `svg_mppi` and `dial_mpc` (for its first update) do so, if the evaluator has no `Sampler`.
  virtual void prepare() noexcept {}

  /// Allocates memory that this evaluator needs in addition, for instance on a GPU. Call it before the first
  /// solve with an evaluator; a `Controller` does so at construction. The solver must not keep a
  /// reference to the evaluator. Throws std::invalid_argument if the evaluator cannot fulfil an option.
  virtual void connect(const BatchEvaluator& /*evaluator*/) {}
};

}  // namespace slalom
