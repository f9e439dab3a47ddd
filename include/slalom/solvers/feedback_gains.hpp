#pragma once

#include <span>
#include <vector>

#include "slalom/core/final_check.hpp"
#include "slalom/core/polymorphic.hpp"

namespace slalom {

class DifferentiableProblem;

/// Linear feedback around a plan: the gains of a time-varying linear-quadratic regulator along it, by the
/// Riccati recursion (D. Q. Mayne, "A second-order gradient method for determining optimal trajectories of
/// non-linear discrete-time systems", Int. J. Control 3, 1966, with linear dynamics). `Feedback`
/// (feedback.hpp) fills it from a problem; use this class directly where the dynamics are not a problem
/// struct.
///
/// Hessians of the cost that are not positive semidefinite are replaced by the nearest matrix that is, so
/// that the gains exist for every cost. An input that the plan holds at a bound because the cost would fall
/// beyond it gets no feedback. The same recursion gives a change of the plan's inputs that lowers its cost:
/// the step of iterative LQR (ilqr.hpp). Construction allocates; nothing else does.
class FeedbackGains {
 public:
  /// The plan around one step and the derivatives there, to be filled before `solve`; matrices row by row.
  /// `expand` fills all but state and inputs. The gradient and the rows of the Hessian have the entries of
  /// the states first, then those of the inputs.
  struct Step {
    std::span<double> state;           ///< x at the start of the step [states]
    std::span<double> inputs;          ///< u [inputs]
    std::span<double> state_jacobian;  ///< A [states][states]
    std::span<double> input_jacobian;  ///< B [states][inputs]
    std::span<double> gradient;        ///< gradient of the stage cost [states + inputs]
    std::span<double> hessian;         ///< Hessian of the stage cost [states + inputs][states + inputs]
  };
  /// The last state and the derivatives of the terminal cost, to be filled before `solve`.
  struct Terminal {
    std::span<double> state;     ///< x at the end of the plan [states]
    std::span<double> gradient;  ///< [states]
    std::span<double> hessian;   ///< [states][states]
  };

  /// Throws std::invalid_argument unless all numbers are at least 1 and there are bounds for each input, the
  /// lower ones at most the upper ones.
  FeedbackGains(int states, int inputs, int steps, const InputBounds& bounds);
  FeedbackGains(const FeedbackGains&);
  FeedbackGains(FeedbackGains&&) noexcept;
  FeedbackGains& operator=(const FeedbackGains&);
  FeedbackGains& operator=(FeedbackGains&&) noexcept;
  ~FeedbackGains();

  int states() const noexcept { return states_; }  ///< scalars of a state
  int inputs() const noexcept { return inputs_; }  ///< inputs of a step
  int steps() const noexcept { return steps_; }    ///< steps of the horizon

  /// Returns the place for the values of step `k`.
  Step step(int k) noexcept;
  /// Returns the place for the values of the plan's end.
  Terminal terminal() noexcept;

  /// Fills the derivatives along the plan, whose states and inputs must have been filled. Returns whether a
  /// function has no derivative somewhere along it (see Dual). Throws as the problem does.
  bool expand(DifferentiableProblem& problem);

  /// Computes the gains for a plan whose steps take `time_step` (s). Returns false, and makes all gains 0, if
  /// a derivative is not finite or a gain would not be.
  bool solve(double time_step) noexcept;

  /// Computes gains and the change of the inputs that lowers the cost of the plan most, as far as linear
  /// dynamics and quadratic costs tell. Inputs that would leave their bounds end at them. The diagonal of the
  /// Hessian by the inputs is multiplied by 1 + `damping`, so that a large damping gives small changes.
  /// Returns false, and makes gains and changes 0, if a derivative is not finite or a gain would not be.
  bool solve_step(double damping) noexcept;

  /// The change of the inputs of step `k` [inputs]; 0 unless it was computed by `solve_step`.
  std::span<const double> change(int k) const noexcept;

  /// The change of the plan's cost that its derivatives predict if its inputs move `part` (0 ... 1) of the
  /// way of their changes.
  double expected_change(double part) const noexcept { return part * (linear_ + 0.5 * part * quadratic_); }

  /// K of step `k` [inputs][states]: near the plan, inputs change by K times the deviation of the state.
  std::span<const double> gain(int k) const noexcept;

  /// K of all steps [steps][inputs][states].
  std::span<const double> gains() const noexcept { return gains_; }

  /// The inputs `u` [inputs] for the state `x` [states] at time `t` (s) after the plan was made:
  /// u_k + K_k (x - x(t)), within the bounds, with x(t) on a line between the plan's states. Before the
  /// plan's start its first state counts, after its end the last. A state or time that is not finite gives
  /// the inputs of the plan.
  void input_at(double t, std::span<const double> x, std::span<double> u) const noexcept;

 private:
  bool recurse(bool change_inputs, double damping) noexcept;
  void begin_step(int k) noexcept;
  int choose_free_inputs(int k) noexcept;
  bool solve_inputs(int k, bool change_inputs, double damping) noexcept;
  void end_step(int k) noexcept;

  struct Workspace;

  int states_, inputs_, steps_;
  InputBounds bounds_;
  double time_step_ = 1;                           ///< s
  double linear_ = 0, quadratic_ = 0;              ///< terms of the expected change of the cost
  std::vector<double> plan_states_, plan_inputs_;  ///< [steps + 1][states], [steps][inputs]
  std::vector<double> jacobians_, gradients_, hessians_, gains_;  ///< values of all steps
  std::vector<double> changes_;                                   ///< [steps][inputs]
  std::vector<int> free_;                                         ///< inputs that may move
  Polymorphic<Workspace> workspace_;
};

}  // namespace slalom
