#pragma once

#include <cstdint>

#include "slalom/core/random.hpp"
#include "slalom/core/sequence_batch.hpp"

namespace slalom {

/// Where a problem's own noise comes from, in place of independent standard normal values: smooth, or of one
/// side, or along the directions that matter. `mppi`, `svg_mppi` and `cem` move it by their means and
/// standard deviations and cut it at the bounds; their formulas take it for normal, of mean 0 and variance 1.
/// `reverse_mppi`, `sv_mpc` and the guides of `svg_mppi` need the normal density and draw their own.
class Sampler {
 public:
  virtual ~Sampler() = default;

  /// Fills the samples `first` ... `first + count - 1` (and the padding after them) of every row of `noise`.
  /// A value may depend on the key, its row and its sample index alone, so that it is the same on any number
  /// of threads. `first` and `count` are multiples of `simd::padding`.
  virtual void fill(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept = 0;
};

/// The seam between solvers and problems: evaluate a batch of control sequences from the current state.
/// Solvers see a problem through this alone, so each is written and compiled once; anything that can evaluate
/// a batch (a problem struct, a physics engine, a callable of another language) can be solved.
class BatchEvaluator {
 public:
  virtual ~BatchEvaluator() = default;

  /// Inputs a step.
  virtual int inputs() const noexcept = 0;

  /// Duration of a step, s; 0 where it is not known (then solvers do not shift their last solution in time).
  virtual double time_step() const noexcept { return 0; }

  /// Whether a call costs so much beside its samples that all samples should come in one. Otherwise solvers
  /// hand over what fits into a cache, from several threads.
  virtual bool whole_batches() const noexcept { return false; }

  /// The problem's own noise, null where it has none.
  virtual const Sampler* sampler() const noexcept { return nullptr; }

  /// The cost of each control sequence `first` ... `first + count - 1` of `batch`, started from the current
  /// state, and whether it collides (1 or 0). `first` is a multiple of `simd::padding`; `costs` and
  /// `collided` are indexed like the batch and hold its padded length; entries up to the next multiple of
  /// `simd::padding` may be written. Called from several threads at once for different ranges.
  virtual void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                        std::uint8_t* collided) const noexcept = 0;
};

}  // namespace slalom
