#pragma once

#include <span>
#include <vector>

#include "slalom/core/final_check.hpp"
#include "slalom/core/polymorphic.hpp"

namespace slalom {

/// Linear feedback around a plan: the gains of a time-varying linear-quadratic regulator along it, by the
/// Riccati recursion (D. Q. Mayne, "A second-order gradient method for determining optimal trajectories of
/// non-linear discrete-time systems", Int. J. Control 3, 1966, with linear dynamics). `Feedback`
/// (feedback.hpp) fills it from a problem; use this class directly where the dynamics are not a problem
/// struct.
///
/// Hessians of the cost that are not positive semidefinite are replaced by the nearest matrix that is, so
/// that the gains exist for every cost. An input that the plan holds at a bound because the cost would fall
/// beyond it gets no feedback. Construction allocates; nothing else does.
class FeedbackGains {
 public:
  /// The plan around one step and the derivatives there, to be filled before `solve`; matrices row by row.
  /// The gradient and the rows of the Hessian have the entries of the states first, then those of the inputs.
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

  /// Computes the gains for a plan whose steps take `time_step` (s). Returns false, and makes all gains 0, if
  /// a derivative is not finite or a gain would not be.
  bool solve(double time_step) noexcept;

  /// K of step `k` [inputs][states]: near the plan, inputs change by K times the deviation of the state.
  std::span<const double> gain(int k) const noexcept;

  /// K of all steps [steps][inputs][states].
  std::span<const double> gains() const noexcept { return gains_; }

  /// The inputs `u` [inputs] for the state `x` [states] at time `t` (s) after the plan was made: u_k + K_k (x
  /// - x(t)), within the bounds, with x(t) on a line between the plan's states. Before the plan's start its
  /// first state counts, after its end the last. One that is not finite gives the inputs of the plan.
  void input_at(double t, std::span<const double> x, std::span<double> u) const noexcept;

 private:
  void begin_step(int k) noexcept;
  int choose_free_inputs(int k) noexcept;
  bool solve_gain(int k) noexcept;
  void end_step(int k) noexcept;

  struct Workspace;

  int states_, inputs_, steps_;
  InputBounds bounds_;
  double time_step_ = 1;                                          ///< s
  std::vector<double> plan_states_, plan_inputs_;                 ///< [steps + 1][states], [steps][inputs]
  std::vector<double> jacobians_, gradients_, hessians_, gains_;  ///< values of all steps
  std::vector<int> free_;                                         ///< inputs that may move
  Polymorphic<Workspace> workspace_;
};

}  // namespace slalom
