#pragma once

#include <cstddef>
#include <span>

namespace slalom {

/// Quality of a gradient of a cost.
enum class GradientQuality {
  exact,       ///< the derivative
  kink,        ///< on one side at most: a function on the way has no derivative there (see Dual)
  not_finite,  ///< none: it is not finite
};

/// Gradients of the cost of control sequences, which an evaluator may offer beside costs
/// (`BatchEvaluator::gradient`).
class CostGradient {
 public:
  virtual ~CostGradient() = default;

  /// The number of values of working memory that `differentiate` needs for sequences of `steps` steps.
  virtual std::size_t workspace(int steps) const noexcept = 0;

  /// Writes the derivatives of the cost of `sequence` [step][input], started from the current state, by each
  /// of its inputs [step][input]. Jumps of the cost do not show. `workspace` holds at least
  /// `workspace(steps)` values. Called from several threads at once, with a workspace for each.
  virtual GradientQuality differentiate(std::span<const float> sequence, std::span<double> workspace,
                                        std::span<float> gradient) const noexcept = 0;
};

}  // namespace slalom
