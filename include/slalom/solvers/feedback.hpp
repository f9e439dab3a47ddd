#pragma once

#include <algorithm>
#include <span>
#include <type_traits>
#include <utility>

#include "slalom/core/derivatives/linearize.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/feedback_gains.hpp"

namespace slalom {

/// Feedback around the plan of a controller, for the time until the next plan: a fast loop reads the state
/// and applies
///
///     u(t, x) = u_k + K_k (x - x(t)),
///
/// where x(t) and u_k are the plan's, and K_k are the gains of the linear-quadratic regulator that the
/// problem's exact derivatives give along the plan (FeedbackGains). For the same purpose Belvedere et al.
/// ("Feedback-MPPI", arXiv 2506.14855) use the sensitivity of the weighted mean of the samples to the initial
/// state; the regulator here needs no samples, and its gains do not depend on the temperature.
///
///     slalom::Feedback feedback{controller};                          // allocates
///     const auto plan = controller.solve(x, {.elapsed = 0.1});
///     feedback.update(controller, plan);                              // gains along the plan
///     ... apply(feedback.input_at(0.004, x));                         // every few milliseconds
///
/// The gains know smooth costs only: a collision whose cost is a jump has no derivative (see Dual). States
/// must be continuous: an angle must not be wrapped between the plan and `input_at`. Bounds on inputs hold,
/// bounds on their rates do not. A copy may be used by another thread.
template <class P>
class Feedback {
  static_assert(detail::Controlled<P>::has_problem && detail::Controlled<P>::predicts,
                "slalom: feedback needs the problem and the predicted states of the controller's evaluator");
  using Problem = std::remove_cvref_t<decltype(std::declval<const Controller<P>&>().problem())>;
  static constexpr int nx = detail::state_size<Problem>, nu = Problem::inputs;

 public:
  using State = detail::StateOf<Problem, double>;  ///< the problem's state in double
  using Inputs = Input<double, nu>;                ///< inputs of a step

  /// Serves the plans of a controller. All gains are 0 until the first `update`. Allocates.
  explicit Feedback(const Controller<P>& controller)
      : gains_(nx, nu, controller.solver().horizon(), controller.bounds()) {}

  /// Computes the gains along a plan, for the controller's problem as it is now, and keeps the plan. Returns
  /// false, and makes all gains 0, if a derivative is not finite. Does not allocate.
  bool update(const Controller<P>& controller, const Plan<P>& plan) noexcept {
    const Problem& problem = controller.problem();
    kink_ = false;
    for (int k = 0; k < steps(); ++k) {
      const State& x = plan.states[static_cast<std::size_t>(k)];
      const Inputs& u = plan.inputs[static_cast<std::size_t>(k)];
      const auto to = gains_.step(k);
      detail::scalars_of<Problem, double>(x, to.state.data());
      std::copy_n(u.value, nu, to.inputs.begin());
      const auto l = linearize(problem, x, u, k);
      std::copy_n(l.state_jacobian[0], nx * nx, to.state_jacobian.begin());
      std::copy_n(l.input_jacobian[0], nx * nu, to.input_jacobian.begin());
      kink_ |= l.kink;
      copy(expand_stage_cost(problem, x, u, k), to);
    }
    const auto end = gains_.terminal();
    detail::scalars_of<Problem, double>(plan.states.back(), end.state.data());
    copy(expand_terminal_cost(problem, plan.states.back()), end);
    const double step = detail::time_step_of(problem);
    return gains_.solve(step > 0 ? step : 1);
  }

  /// The inputs for state `x` at time `t` (s) after the plan was made, within the bounds. Before the plan's
  /// start its first state counts, after its end the last. Time is counted in steps if the problem has no
  /// `dt`. A state or time that is not finite, or feedback that is not, gives the inputs of the plan.
  Inputs input_at(double t, const State& x) const noexcept {
    double now[nx];
    detail::scalars_of<Problem, double>(x, now);
    Inputs u;
    gains_.input_at(t, now, u.value);
    return u;
  }

  /// Steps of the plan.
  int steps() const noexcept { return gains_.steps(); }
  /// K of step `k` [inputs][states], row by row.
  std::span<const double> gain(int k) const noexcept { return gains_.gain(k); }
  /// Whether a function has no derivative somewhere along the plan (see Dual), so that the gains near there
  /// hold on one side at most.
  bool has_kink() const noexcept { return kink_; }

 private:
  template <int N>
  void copy(const CostExpansion<N>& cost, const auto& to) noexcept {
    std::copy_n(cost.gradient, N, to.gradient.begin());
    std::copy_n(cost.hessian[0], N * N, to.hessian.begin());
    kink_ |= cost.kink;
  }

  FeedbackGains gains_;
  bool kink_ = false;
};

template <class P>
Feedback(const Controller<P>&) -> Feedback<P>;

}  // namespace slalom
