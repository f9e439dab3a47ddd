#pragma once

#include "slalom/core/random.hpp"
#include "slalom/core/sequence_batch.hpp"

namespace slalom {

/// Source of a problem's own noise, used instead of independent standard normal values: for example smooth or
/// one-sided noise. `mppi`, `svg_mppi`, `cem`, `icem` and `dial_mpc` scale it by their standard deviations,
/// shift it by their means and clamp it to the bounds; their formulas assume a normal distribution with mean
/// 0 and variance 1. `reverse_mppi`, `sv_mpc` and the guides of `svg_mppi` need the normal density and draw
/// normal values.
class Sampler {
 public:
  virtual ~Sampler() = default;

  /// Fills the samples `first` ... `first + count - 1` (and the padding after them) of every row of `noise`.
  /// A value must depend only on the key, its row and its sample index, so that it is the same on any number
  /// of threads. `first` and `count` are multiples of `simd::padding`.
  virtual void fill(SequenceBatch& noise, int first, int count, RandomKey key) const noexcept = 0;
};

/// The interface between solvers and problems: evaluates a batch of control sequences from the current state.
/// Solvers use a problem only through this interface, so each solver is compiled once; anything that can
/// evaluate a batch (a problem struct, a physics engine, a function of another language) can be solved.
class BatchEvaluator {
 public:
  virtual ~BatchEvaluator() = default;

  /// Number of inputs per step.
  virtual int inputs() const noexcept = 0;

  /// Duration of a step, s; 0 if unknown (then solvers do not shift their last solution in time).
  virtual double time_step() const noexcept { return 0; }

  /// Whether all samples should be evaluated in one call, because a call has a high fixed cost. Otherwise
  /// solvers evaluate ranges that fit into a cache, from several threads.
  virtual bool whole_batches() const noexcept { return false; }

  /// The problem's own noise, or null.
  virtual const Sampler* sampler() const noexcept { return nullptr; }

  /// The cost of each control sequence `first` ... `first + count - 1` of `batch`, started from the current
  /// state, and whether it collides (1 or 0). `first` is a multiple of `simd::padding`; `costs` and
  /// `collided` are indexed like the batch and hold its padded length; entries up to the next multiple of
  /// `simd::padding` may be written. Called from several threads at once for different ranges.
  virtual void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                        std::uint8_t* collided) const noexcept = 0;
};

}  // namespace slalom
