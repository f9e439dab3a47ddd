#pragma once

#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "slalom/solvers/controlled.hpp"
#include "slalom/solvers/controller_core.hpp"
#include "slalom/solvers/registry.hpp"

namespace slalom {

/// The answer of a controller: the inputs to apply and the predicted states. Its spans point into the
/// controller and stay valid until the next solve or reset.
template <class P>
struct Plan {
  using State = typename detail::Controlled<P>::State;  ///< the problem's state in double

  Status status = Status::ok;                                            ///< how the solve ended
  std::span<const Input<double, detail::Controlled<P>::inputs>> inputs;  ///< [horizon]; apply the first now
  /// [horizon + 1]; the first is the state given. Empty if the evaluator has no `predict`.
  std::span<const State> states;
  double cost = 0;                       ///< cost of the plan
  bool collided = false;                 ///< whether the plan collides
  std::span<const CostTerm> cost_terms;  ///< the parts of the cost, which sum to it
  const SolveResult& stats;              ///< samples, weights, guides, times ...
  /// Number of values that the final check changed in this solve: inputs outside the bounds or rates, costs
  /// and states that are not finite, and invalid values given to `set_previous_input`. 0 in normal operation.
  int corrections = 0;
  /// Whether the file that solves is compiled with optimisation. Without, a solve takes 40 times as long.
#ifdef __OPTIMIZE__
  static constexpr bool optimised = true;
#else
  static constexpr bool optimised = false;
#endif
};

/// Joins a problem, or your own evaluator (`StateEvaluator`), with a solver, and solves it again and again:
///
///     slalom::SvgMppi controller{Pendulum{}, {.horizon = 60, .input_min = {-5}, .input_max = {5}}};
///     const auto plan = controller.solve(x, {.elapsed = 0.02, .deadline = 0.002});
///     if (plan.status == slalom::Status::ok) apply(plan.inputs[0]);
///
/// Construction allocates and may throw std::invalid_argument; `solve` does neither. The inputs of a plan are
/// always finite, within bounds and rates; its cost and states are always finite (final_check.hpp).
///
/// A copy continues bit for bit like the original. It has its own problem and solver and shares only the
/// threads. Both controllers may be used at the same time (see ThreadPool).
template <class P>
class Controller {
  using Controlled = detail::Controlled<P>;
  static constexpr int input_count = Controlled::inputs;
  static constexpr std::size_t state_size = sizeof(typename Controlled::State) / sizeof(double);

 public:
  using Evaluator = typename Controlled::Evaluator;  ///< type of the evaluator
  using State = typename Controlled::State;          ///< the problem's state in double
  using Inputs = Input<double, input_count>;         ///< inputs of a step

  /// Makes a solver from the options of any method. The bounds that the problem states for its inputs narrow
  /// those of the options. The controller starts its own threads unless `pool` is given. Throws
  /// std::invalid_argument if an option is out of range, if the problem states invalid bounds, or if an
  /// option needs something that the evaluator does not have.
  Controller(P problem, const SolverOptions& options, std::shared_ptr<ThreadPool> pool = nullptr)
      : problem_(std::move(problem)),
        options_(std::make_shared<const SolverOptions>(options)),
        core_(problem_, options, [&](const SolverOptions& narrowed) {
          return make_solver(narrowed, input_count, std::move(pool));
        }) {
    allocate();
  }

  /// Uses your own solver, which keeps its own bounds; the bounds of the problem hold as well. Throws
  /// std::invalid_argument if the solver is null or made for another number of inputs.
  Controller(P problem, std::unique_ptr<Solver> solver)
      : problem_(std::move(problem)), core_(problem_, std::move(solver)) {
    allocate();
  }

  /// Solves from state `x` and returns the plan. If the state is not finite, or a time of the request is not
  /// valid (`Status::invalid_time`), repeats the last plan.
  Plan<P> solve(const State& x, const SolveRequest& request = {}) noexcept {
    double values[state_size];
    std::memcpy(values, &x, sizeof values);
    if (core_.begin(problem_, values, request)) {
      core_.solve(problem_, evaluator(), request);
      core_.finish(problem_);
      predict_plan(x);
      core_.check_cost(cost_.value);
      for (CostTerm& term : terms_) core_.check_cost(term.value);
      core_.check_states(values, {reinterpret_cast<double*>(states_.data()), states_.size() * state_size});
    }
    return {core_.status(), inputs(), states_,           cost_.value,
            cost_.collided, terms_,   solver().result(), core_.corrections()};
  }

  /// Sets the input that was applied before the next solve, for a problem with `input_rate_max`. Without this
  /// call the controller assumes the input that the last plan has for that time, and before the first plan
  /// the value within the bounds that is nearest to 0. Values outside the bounds are moved into them; values
  /// that are not finite are ignored.
  void set_previous_input(const Inputs& u) noexcept { core_.set_previous_input(u.value); }

  /// The problem, to change its parameters between solves.
  auto& problem() noexcept requires Controlled::has_problem { return evaluator().problem(); }
  /// The problem.
  const auto& problem() const noexcept requires Controlled::has_problem { return evaluator().problem(); }
  /// The evaluator of the problem, or the one given.
  Evaluator& evaluator() noexcept { return problem_.evaluator(); }
  /// The evaluator.
  const Evaluator& evaluator() const noexcept { return problem_.evaluator(); }
  /// The solver in use.
  const Solver& solver() const noexcept { return core_.solver(); }
  /// The options given; null with a solver of your own.
  const SolverOptions* options() const noexcept { return options_.get(); }
  /// The bounds of the inputs: those that the problem stated at construction, narrowed by the options.
  const InputBounds& bounds() const noexcept { return core_.bounds(); }

  /// Resets the solver, with random numbers from `seed`, and the inputs to those before the first solve.
  /// States and cost of the last plan remain until a solve from a finite state; the problem is not changed.
  void reset(std::uint64_t seed) noexcept { core_.reset(problem_, seed); }
  /// Draws the noise of the next solve ahead, outside its deadline. Has an effect with `mppi`, `svg_mppi` and
  /// `dial_mpc` only (see Solver::prepare).
  void prepare() noexcept { core_.solver().prepare(); }

 private:
  void allocate() {
    const int steps = solver().horizon();
    if constexpr (Controlled::predicts) {
      states_.resize(static_cast<std::size_t>(steps) + 1);
    } else {
      alone_ = SequenceBatch(steps, input_count, 1);
      alone_cost_ = AlignedBuffer(alone_.stride());
      alone_collided_.resize(static_cast<std::size_t>(alone_.stride()));
    }
  }

  std::span<const Inputs> inputs() const noexcept { return detail::as_inputs<input_count>(core_.inputs()); }

  /// Predicts the states under the plan's inputs, and their cost.
  void predict_plan(const State& x) noexcept {
    const int steps = solver().horizon();
    if constexpr (!StateEvaluator<P>) {
      cost_ = predict(problem(), x, inputs().data(), steps, states_.data(), &terms_);
    } else {
      if constexpr (Controlled::predicts) {
        cost_ = evaluator().predict(x, inputs().data(), steps, states_.data());
      } else {
        for (int row = 0; row < alone_.rows(); ++row)
          alone_.data(row)[0] = static_cast<float>(core_.inputs()[static_cast<std::size_t>(row)]);
        evaluator().evaluate(alone_, 0, 1, alone_cost_.data(), alone_collided_.data());
        cost_ = {static_cast<double>(alone_cost_[0]), alone_collided_[0] != 0};
      }
      terms_[0].value = cost_.value;
    }
  }

  detail::ControlledEvaluator<P> problem_;
  std::shared_ptr<const SolverOptions> options_;
  ControllerCore core_;
  std::vector<State> states_;
  Cost<double> cost_{0.0, false};
  decltype(Controlled::cost_terms()) terms_ = Controlled::cost_terms();
  SequenceBatch alone_;  ///< the plan as a batch of one, for an evaluator that does not predict
  AlignedBuffer alone_cost_;
  std::vector<std::uint8_t> alone_collided_;
};

}  // namespace slalom
