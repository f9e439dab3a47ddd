#pragma once

#include <algorithm>
#include <span>

#include "slalom/core/derivatives/linearize.hpp"
#include "slalom/solvers/feedback_gains.hpp"

namespace slalom {

/// A problem as feedback and iterative LQR need it: in double, one state at a time, with derivatives.
/// `ProblemDerivatives` makes one of a problem struct. Derive from it where the dynamics are not a problem
/// struct.
class DifferentiableProblem {
 public:
  virtual ~DifferentiableProblem() = default;

  /// Writes the state `next` [states] that follows from `x` [states] with the inputs `u` [inputs] of step
  /// `k`. `next` and `x` do not overlap.
  virtual void step(int k, std::span<const double> x, std::span<const double> u, std::span<double> next) = 0;

  /// The cost of the control sequence `inputs` [steps][inputs] from state `x` [states].
  virtual double cost(std::span<const double> x, std::span<const double> inputs) = 0;

  /// Fills the derivatives of step `k` at the state and inputs of `at`. Returns whether a function has no
  /// derivative there (see Dual).
  virtual bool expand_step(int k, const FeedbackGains::Step& at) = 0;

  /// Fills the derivatives of the terminal cost at the state of `at`, as `expand_step`.
  virtual bool expand_end(const FeedbackGains::Terminal& at) = 0;
};

/// A problem struct with its exact derivatives. Does not allocate.
template <Problem P>
class ProblemDerivatives final : public DifferentiableProblem {
  static constexpr int nx = detail::state_size<P>, nu = P::inputs;

 public:
  using State = detail::StateOf<P, double>;  ///< the problem's state in double
  using Inputs = Input<double, nu>;          ///< inputs of a step

  /// The problem must outlive this object.
  explicit ProblemDerivatives(const P& problem) noexcept : problem_(&problem) {}

  void step(int k, std::span<const double> x, std::span<const double> u,
            std::span<double> next) noexcept override {
    const State now = to_state(x);
    detail::scalars_of<P, double>(detail::step<P, double>(*problem_, now, look_up(now), to_inputs(u), k),
                                  next.data());
  }

  double cost(std::span<const double> x, std::span<const double> inputs) noexcept override {
    double total = 0;
    State now = to_state(x);
    for (int k = 0; !inputs.empty(); ++k, inputs = inputs.subspan(nu)) {
      const Inputs u = to_inputs(inputs);
      const auto seen = look_up(now);
      total += detail::total_of(detail::stage_cost<P, double>(*problem_, now, seen, u, k));
      now = detail::step<P, double>(*problem_, now, seen, u, k);
    }
    return total + detail::total_of(detail::terminal_cost<P, double>(*problem_, now, look_up(now)));
  }

  bool expand_step(int k, const FeedbackGains::Step& at) noexcept override {
    const State x = to_state(at.state);
    const Inputs u = to_inputs(at.inputs);
    const auto l = linearize(*problem_, x, u, k);
    std::copy_n(l.state_jacobian[0], nx * nx, at.state_jacobian.begin());
    std::copy_n(l.input_jacobian[0], nx * nu, at.input_jacobian.begin());
    return copy(expand_stage_cost(*problem_, x, u, k), at) || l.kink;
  }

  bool expand_end(const FeedbackGains::Terminal& at) noexcept override {
    return copy(expand_terminal_cost(*problem_, to_state(at.state)), at);
  }

 private:
  template <int N>
  static bool copy(const CostExpansion<N>& cost, const auto& to) noexcept {
    std::copy_n(cost.gradient, N, to.gradient.begin());
    std::copy_n(cost.hessian[0], N * N, to.hessian.begin());
    return cost.kink;
  }
  static State to_state(std::span<const double> x) noexcept { return detail::state_of<P, double>(x.data()); }
  static Inputs to_inputs(std::span<const double> u) noexcept {
    return detail::inputs_of<P, double>(u.data());
  }
  auto look_up(const State& x) const noexcept { return detail::look_up<P, double>(*problem_, x); }

  const P* problem_;
};

}  // namespace slalom
