#pragma once

#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "slalom/core/problem_check.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/make_solver.hpp"

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

  /// With the options of any method. Throws std::invalid_argument that names the option, its value and the
  /// rule. Threads are the controller's own unless a pool is given to share.
  Controller(P problem, const SolverOptions& options, std::shared_ptr<ThreadPool> pool = nullptr)
      : Controller(std::move(problem), make_solver(options, P::inputs, std::move(pool))) {}

  /// With a solver of one's own. Throws std::invalid_argument on none and on one for other inputs.
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
      return {Status::non_finite_state, inputs_, states_, cost_.value, cost_.collided, stats};
    }
    evaluator_.set_state(x);
    result_ = &solver_->solve(evaluator_, request);
    for (std::size_t k = 0; k < inputs_.size(); ++k)
      for (std::size_t i = 0; i < P::inputs; ++i)
        inputs_[k].value[i] = static_cast<double>(result_->inputs[k * P::inputs + i]);
    cost_ = predict(evaluator_.problem(), x, inputs_.data(), solver_->horizon(), states_.data());
    return {result_->status, inputs_, states_, cost_.value, cost_.collided, *result_};
  }

  /// The problem, to change its parameters between solves.
  P& problem() noexcept { return evaluator_.problem(); }
  const P& problem() const noexcept { return evaluator_.problem(); }
  const Solver& solver() const noexcept { return *solver_; }

  /// Forgets everything and starts the random numbers anew.
  void reset(std::uint64_t seed) noexcept { solver_->reset(seed); }
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
  const SolveResult* result_ = nullptr;
};

}  // namespace slalom
