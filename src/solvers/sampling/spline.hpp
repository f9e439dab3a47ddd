#pragma once

#include <vector>

#include "slalom/core/batch_evaluator.hpp"
#include "solvers/kernels/kernels.hpp"

namespace slalom::detail {

/// Control sequences as clamped uniform B-splines of degree three (with fewer than four control points, of a
/// lower one): an input at a step is the weighted mean of the control points near it. The weights are not
/// negative and sum to 1 (L. Piegl and W. Tiller, "The NURBS Book", 2nd ed., section 2.2), so a sequence is
/// within the bounds if its control points are. Control points are [point][input], sequences [step][input].
class Spline {
 public:
  /// None: `active` is false.
  Spline() = default;
  /// Uses at most as many control points as steps.
  Spline(int steps, int points, int inputs);

  bool active() const noexcept { return points_ > 0; }
  int points() const noexcept { return points_; }  ///< control points

  /// The sequence of these control points.
  void expand(const float* points, float* sequence) const noexcept;
  /// The variances of a sequence whose control points are independent and have these.
  void expand_variances(const float* points, float* sequence) const noexcept;
  /// The sequences of a range of a batch of control points; `range.count` is a multiple of the padding.
  void expand(const SequenceBatch& points, SequenceBatch& sequences, Range range) const noexcept;

  /// Moves control points forward in time by `shift` >= 0 steps, to those whose sequence is nearest to the
  /// shifted one in the least squares sense; they may leave the bounds. The last input is held.
  void shift(float* points, double shift) noexcept;

 private:
  static constexpr int most_ = 4;  ///< control points that an input depends on

  int steps_ = 0, points_ = 0, inputs_ = 0;
  int count_ = 0;                        ///< control points that an input depends on
  std::vector<int> first_;               ///< first control point of each step
  std::vector<float> weights_;           ///< [step][count]
  std::vector<float> fit_;               ///< least squares, [point][step]
  std::vector<float> sequence_, moved_;  ///< [step][input]
};

/// An evaluator of control points: it evaluates the sequences of their splines.
class SplineEvaluator final : public BatchEvaluator {
 public:
  /// `sequences` has room for as many samples as the batches of control points. The arguments must outlive
  /// this object.
  SplineEvaluator(const BatchEvaluator& evaluator, const Spline& spline, SequenceBatch& sequences) noexcept
      : evaluator_(&evaluator), spline_(&spline), sequences_(&sequences) {}

  int inputs() const noexcept override { return evaluator_->inputs(); }
  double time_step() const noexcept override { return evaluator_->time_step(); }
  bool whole_batches() const noexcept override { return evaluator_->whole_batches(); }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    spline_->expand(batch, *sequences_, {first, padded(count)});
    evaluator_->evaluate(*sequences_, first, count, costs, collided);
  }

 private:
  const BatchEvaluator* evaluator_;
  const Spline* spline_;
  SequenceBatch* sequences_;
};

}  // namespace slalom::detail
