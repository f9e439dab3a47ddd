#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "slalom/core/options.hpp"
#include "slalom/solvers/controller.hpp"
#include "slalom/solvers/differentiable_problem.hpp"

namespace slalom {

/// Options of iterative LQR.
/// `visit_options` below describes the fields.
struct IlqrOptions {
  int iterations = 5;
};

template <class Options, class Visit>
requires is_options_of<Options, IlqrOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.iterations,
        {"iterations", "", "most steps of an improvement; each computes derivatives once", 1, 1000});
}

/// Improves a control sequence by iterative LQR (W. Li and E. Todorov, "Iterative linear quadratic regulator
/// design for nonlinear biological movement systems", ICINCO 2004). Each step solves a linear-quadratic
/// problem around the sequence, by FeedbackGains, and moves the inputs as far towards its solution as the
/// cost of the problem falls:
///
///     u_k <- u_k + s c_k + K_k (x_k' - x_k),   s = 1, 1/2, 1/4, ...
///
/// c_k are the changes of the inputs, K_k the gains, and x_k' the states that the new inputs lead to. Inputs
/// stay within their bounds, and those that reach one are solved for no longer (in the manner of Y. Tassa, N.
/// Mansard and E. Todorov, "Control-limited differential dynamic programming", ICRA 2014). If no s lowers the
/// cost, the step is damped as by Levenberg and Marquardt. So the cost falls with every step, or the sequence
/// stays as it is.
///
/// `Ilqr` is this class for a problem struct. Construction allocates; `improve` does not, and throws only as
/// the problem does.
class IterativeLqr {
 public:
  /// Throws std::invalid_argument unless all numbers are at least 1, there are bounds for each input, the
  /// lower ones at most the upper ones, and the options are in their ranges.
  IterativeLqr(int states, int inputs, int steps, const InputBounds& bounds, const IlqrOptions& options = {});

  /// Sets the sequence [steps][inputs] that is improved next, moved into the bounds. If it is shorter than
  /// the horizon, its last inputs are held; values beyond its last whole step are not used. An empty one sets
  /// the values within the bounds that are nearest to 0, with which this object starts.
  void start_from(std::span<const double> inputs) noexcept;
  /// Moves the sequence forward by `steps` >= 0 steps, which may be fractional.
  void shift(double steps) noexcept;

  /// Improves the sequence from state `x` [states], and returns it [steps][inputs]; valid until the next
  /// call. If its cost or a derivative is not finite, it stays as it is.
  std::span<const double> improve(DifferentiableProblem& problem, std::span<const double> x);

  int steps() const noexcept { return gains_.steps(); }  ///< steps of the horizon
  double cost() const noexcept { return cost_; }  ///< cost of the sequence that the last improvement returned
  double first_cost() const noexcept { return first_cost_; }  ///< before the last improvement
  int iterations() const noexcept { return iterations_; }     ///< steps of the last improvement
  /// Whether the last improvement met a function without derivative (see Dual).
  bool has_kink() const noexcept { return kink_; }

 private:
  double try_inputs(DifferentiableProblem& problem, double part, bool follow);
  void take_inputs() noexcept;
  bool lower_cost(DifferentiableProblem& problem);

  FeedbackGains gains_;  ///< around the sequence and its states
  InputBounds bounds_;
  int most_iterations_;
  std::vector<double> inputs_, states_;              ///< the sequence, [steps][inputs], [steps + 1][states]
  std::vector<double> tried_inputs_, tried_states_;  ///< sequence of a step that may be taken
  double cost_ = 0, first_cost_ = 0;
  double damping_ = 0;
  int iterations_ = 0;
  bool kink_ = false;
};

/// Iterative LQR for a problem struct, with its exact derivatives. As one more guide of a sampling method:
///
///     slalom::Proposals proposals{controller, 1};
///     slalom::Ilqr ilqr{controller, {.iterations = 3}};                        // allocates
///     proposals.clear();
///     proposals.add(ilqr.improve(controller.problem(), x, 0.02));              // 0.02 s after the last call
///     const auto plan = controller.solve(x, {.elapsed = 0.02, .proposals = proposals});
///     ilqr.start_from(plan.inputs);                                            // improves the plan next
///
/// By itself it is a controller for smooth problems with one good way:
///
///     slalom::Ilqr ilqr{problem, 60};
///     apply(ilqr.improve(problem, x, 0.02)[0]);
///
/// It sees derivatives only: jumps of a cost stop its steps, but nothing leads it around them. Limits
/// on the rates of inputs are not applied.
template <Problem P>
class Ilqr {
  static constexpr int nx = detail::state_size<P>, nu = P::inputs;

 public:
  using State = detail::StateOf<P, double>;  ///< the problem's state in double
  using Inputs = Input<double, nu>;          ///< inputs of a step

  /// Improves sequences of `horizon` steps within the bounds of the problem. Throws std::invalid_argument
  /// that names the value out of range.
  Ilqr(const P& problem, int horizon, const IlqrOptions& options = {})
      : Ilqr(horizon, detail::stated_bounds(problem), options) {}
  /// Takes horizon and bounds of a controller. Throws std::invalid_argument if an option is out of
  /// range.
  template <class C>
  explicit Ilqr(const Controller<C>& controller, const IlqrOptions& options = {})
      : Ilqr(controller.solver().horizon(), controller.bounds(), options) {}

  /// The best sequence from state `x` that the steps find, [horizon]; valid until the next call. They start
  /// from the last sequence, moved forward by `elapsed` (s) if the problem tells the duration of its steps.
  std::span<const Inputs> improve(const P& problem, const State& x, double elapsed = 0) noexcept {
    const double step = detail::time_step_of(problem);
    if (step > 0 && elapsed > 0) lqr_.shift(elapsed / step);
    double start[nx];
    detail::scalars_of<P, double>(x, start);
    ProblemDerivatives derivatives(problem);
    std::span<const double> values = lqr_.improve(derivatives, start);
    for (Inputs& u : inputs_) {
      std::copy_n(values.begin(), nu, u.value);
      values = values.subspan(nu);
    }
    return inputs_;
  }

  /// Sets the sequence that is improved next, moved into the bounds. If it is shorter than the horizon, its
  /// last inputs are held; if it is empty, the inputs are those nearest to 0.
  void start_from(std::span<const Inputs> inputs) noexcept {
    std::size_t values = 0;
    for (const Inputs& u : inputs.first(std::min(inputs.size(), inputs_.size())))
      values = static_cast<std::size_t>(std::copy_n(u.value, nu, start_.begin() + values) - start_.begin());
    lqr_.start_from(std::span(start_).first(values));
  }

  /// Cost, iterations and kinks of the last improvement.
  const IterativeLqr& result() const noexcept { return lqr_; }

 private:
  Ilqr(int horizon, const InputBounds& bounds, const IlqrOptions& options)
      : lqr_(nx, nu, horizon, bounds, options),
        inputs_(static_cast<std::size_t>(horizon)),
        start_(inputs_.size() * static_cast<std::size_t>(nu)) {}

  IterativeLqr lqr_;
  std::vector<Inputs> inputs_;
  std::vector<double> start_;  ///< [step][input], as `IterativeLqr` takes it
};

/// Takes the type of the problem from the argument.
template <Problem P>
Ilqr(const P&, int, IlqrOptions = {}) -> Ilqr<P>;
/// Takes the type of the problem from its controller.
template <class C>
Ilqr(const Controller<C>&, IlqrOptions = {})
    -> Ilqr<std::remove_cvref_t<decltype(std::declval<const Controller<C>&>().problem())>>;

}  // namespace slalom
