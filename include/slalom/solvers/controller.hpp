#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "slalom/core/problem_check.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/registry.hpp"

namespace slalom {

/// What a controller wants to do: the inputs to apply and the states they are predicted to lead to. Its spans
/// point into the controller and stay valid until the next solve or reset.
template <Problem P>
struct Plan {
  using State = detail::StateOf<P, double>;

  Status status = Status::ok;
  std::span<const Input<double, P::inputs>> inputs;  ///< [horizon]; the first is for now
  std::span<const State> states;                     ///< [horizon + 1]; the first is the state given
  double cost = 0;                                   ///< of the plan
  bool collided = false;                             ///< whether the plan collides
  std::span<const CostTerm> cost_terms;              ///< what its cost is made of; they sum to it
  const SolveResult& stats;                          ///< samples, weights, guides, times ...
};

/// A problem and a method that solves it, over and over:
///
///     slalom::SvgMppi controller{Pendulum{}, {.horizon = 60, .input_min = {-5}, .input_max = {5}}};
///     const auto plan = controller.solve(x, {.elapsed = 0.02, .deadline = 0.002});
///     if (plan.status == slalom::Status::ok) apply(plan.inputs[0]);
///
/// Construction allocates and may throw std::invalid_argument; `solve` does neither.
template <class P>
class Controller {
  static_assert(detail::check_problem<P>());

 public:
  using State = detail::StateOf<P, double>;

  /// With the options of any method, within the bounds that the problem states for its inputs. Throws
  /// std::invalid_argument that names the option, its value and the rule. Threads are the controller's own
  /// unless a pool is given to share.
  Controller(P problem, const SolverOptions& options, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller(problem, make_solver(within_bounds(problem, options), P::inputs, std::move(pool))) {}

  /// With a solver of one's own, which keeps its own bounds. Throws std::invalid_argument on none and on one
  /// for other inputs.
  Controller(P problem, std::unique_ptr<Solver> solver)
      : evaluator_(std::move(problem)), solver_(checked(std::move(solver))) {
    const auto steps = static_cast<std::size_t>(solver_->horizon());
    inputs_.resize(steps);
    states_.resize(steps + 1);
  }

  /// The plan from state `x`. Where the state is not finite nothing is solved and the last plan is repeated.
  Plan<P> solve(const State& x, const SolveRequest& request = {}) noexcept {
    if (!finite(x)) {
      static const SolveResult nothing{};
      const SolveResult& stats = result_ ? *result_ : nothing;
      return {Status::non_finite_state, inputs_, states_, cost_.value, cost_.collided, terms_, stats};
    }
    evaluator_.set_state(x);
    if constexpr (detail::limits_rates<P>) {
      recall_input(request.elapsed);
      evaluator_.set_previous_input(previous_);
    }
    result_ = &solver_->solve(evaluator_, request);
    for (std::size_t k = 0; k < inputs_.size(); ++k)
      for (std::size_t i = 0; i < P::inputs; ++i)
        inputs_[k].value[i] = static_cast<double>(result_->inputs[k * P::inputs + i]);
    if constexpr (detail::limits_rates<P>)
      hold_input_rates(evaluator_.problem(), previous_, inputs_.data(), solver_->horizon());
    cost_ = predict(evaluator_.problem(), x, inputs_.data(), solver_->horizon(), states_.data(), &terms_);
    return {result_->status, inputs_, states_, cost_.value, cost_.collided, terms_, *result_};
  }

  /// Tells a problem with `input_rate_max` what was applied before the next solve. Unless told, it is taken
  /// to be what the last plan had for then (0 before the first).
  void set_previous_input(const Input<double, P::inputs>& u) noexcept {
    previous_ = u;
    told_ = true;
  }

  /// The problem, to change its parameters between solves.
  P& problem() noexcept { return evaluator_.problem(); }
  const P& problem() const noexcept { return evaluator_.problem(); }
  const Solver& solver() const noexcept { return *solver_; }

  /// Forgets everything and starts the random numbers anew.
  void reset(std::uint64_t seed) noexcept {
    solver_->reset(seed);
    previous_ = {};
    told_ = true;
  }
  /// Draws the noise of the next solve ahead, outside its deadline.
  void prepare() noexcept { solver_->prepare(); }

 private:
  static std::unique_ptr<Solver> checked(std::unique_ptr<Solver> solver) {
    if (!solver) throw std::invalid_argument("solver: there is none");
    if (solver->inputs() != P::inputs) {
      throw std::invalid_argument("solver: made for " + std::to_string(solver->inputs()) +
                                  " inputs, the problem has " + std::to_string(P::inputs));
    }
    return solver;
  }

  /// The options with their bounds narrowed to the problem's.
  static SolverOptions within_bounds(const P& problem, SolverOptions options) {
    std::visit(
        [&](auto& o) {
          if constexpr (detail::has_input_min<P>)
            o.input_min = narrowed(o.input_min, [&](double bound, int i) {
              return std::max(bound, detail::least_input(problem, i));
            });
          if constexpr (detail::has_input_max<P>)
            o.input_max = narrowed(o.input_max, [&](double bound, int i) {
              return std::min(bound, detail::largest_input(problem, i));
            });
        },
        options);
    return options;
  }
  template <class Narrow>
  static PerInput narrowed(const PerInput& bound, Narrow&& narrow) {
    if (!bound.fits(P::inputs)) return bound;  // the solver's own check will say so
    std::vector<double> values;
    for (int i = 0; i < P::inputs; ++i) values.push_back(narrow(bound[i], i));
    return values;
  }

  /// The input that the last plan had for `elapsed` (s) after it was made: what is being applied.
  void recall_input(double elapsed) noexcept {
    if (std::exchange(told_, false)) return;
    const double step = detail::time_step_of(evaluator_.problem());
    const double last = static_cast<double>(inputs_.size() - 1);
    const double now = step > 0 && elapsed > step ? std::min(std::round(elapsed / step) - 1, last) : 0;
    previous_ = inputs_[static_cast<std::size_t>(now)];
  }

  static bool finite(const State& x) noexcept {
    double values[detail::state_size<P>];
    std::memcpy(values, &x, sizeof values);
    for (const double value : values)
      if (!std::isfinite(value)) return false;
    return true;
  }

  ProblemEvaluator<P> evaluator_;
  std::unique_ptr<Solver> solver_;
  std::vector<Input<double, P::inputs>> inputs_;
  std::vector<State> states_;
  Cost<double> cost_{0.0, false};
  CostTermsOf<P> terms_ = detail::cost_terms_of<P>();
  Input<double, P::inputs> previous_{};
  bool told_ = true;  ///< what was applied before the next solve is in `previous_`
  const SolveResult* result_ = nullptr;
};

}  // namespace slalom
