#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "slalom/core/final_check.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/polymorphic.hpp"
#include "slalom/solvers/controlled.hpp"
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
  /// Whether the source file that solves is compiled with optimisation. Without, a solve takes about 40 times
  /// longer.
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
/// always finite, within the bounds and within the rates; its cost and states are always finite
/// (final_check.hpp).
///
/// A copy continues bit for bit like the original. It has its own problem and solver and shares only the
/// threads. Both controllers may be used at the same time (see ThreadPool).
template <class P>
class Controller {
  using Controlled = detail::Controlled<P>;
  static constexpr int input_count = Controlled::inputs;

 public:
  using Evaluator = typename Controlled::Evaluator;  ///< type of the evaluator
  using State = typename Controlled::State;          ///< the problem's state in double
  using Inputs = Input<double, input_count>;         ///< inputs of a step

  /// Makes a solver from the options of any method. The bounds that the problem states for its inputs narrow
  /// those of the options. The controller starts its own threads unless `pool` is given. Throws
  /// std::invalid_argument if an option is out of range, if the problem states invalid bounds, or if an
  /// option needs something that the evaluator does not have.
  Controller(P problem, const SolverOptions& options, std::shared_ptr<ThreadPool> pool = nullptr)
      : evaluator_(std::move(problem)),
        bounds_(bounds_of(evaluator_, &options)),
        options_(std::make_shared<const SolverOptions>(options)),
        solver_(make_solver(within_bounds(options), input_count, std::move(pool))) {
    allocate();
  }

  /// Uses your own solver, which keeps its own bounds; the bounds of the problem hold as well. Throws
  /// std::invalid_argument if the solver is null or made for another number of inputs.
  Controller(P problem, std::unique_ptr<Solver> solver)
      : evaluator_(std::move(problem)),
        bounds_(bounds_of(evaluator_, nullptr)),
        solver_(checked(std::move(solver))) {
    allocate();
  }

  /// Solves from state `x` and returns the plan. If the state is not finite, or a time of the request is not
  /// valid (`Status::invalid_time`), repeats the last plan.
  Plan<P> solve(const State& x, const SolveRequest& request = {}) noexcept {
    corrections_ = 0;
    if (!finite(x)) return plan(Status::non_finite_state);
    if (!valid_times(request, evaluator_.time_step())) return plan(Status::invalid_time);
    evaluator_.set_state(x);
    if constexpr (Controlled::uses_previous_input) {
      recall_input(request.elapsed);
      evaluator_.set_previous_input(previous_);
    }
    const SolveResult& result = solver_->solve(evaluator_, request);
    const float* value = result.inputs.data();
    for (Inputs& input : inputs_)
      for (int i = 0; i < input_count; ++i) input[i] = static_cast<double>(*value++);
    if constexpr (Controlled::has_problem && Controlled::uses_previous_input)
      hold_input_rates(evaluator_.problem(), previous_, inputs_.data(), solver_->horizon());
    check_plan_inputs();
    predict_plan(x);
    return plan(check_prediction(x) ? result.status : Status::degenerate);
  }

  /// Sets the input that was applied before the next solve, for a problem with `input_rate_max`. Without this
  /// call the controller assumes the input that the last plan has for that time, and before the first plan
  /// the value within the bounds that is nearest to 0. Values outside the bounds are moved into them; values
  /// that are not finite are ignored.
  void set_previous_input(const Inputs& u) noexcept {
    given_ = u;
    told_ = true;
  }

  /// The problem, to change its parameters between solves.
  auto& problem() noexcept requires Controlled::has_problem { return evaluator_.problem(); }
  /// The problem.
  const auto& problem() const noexcept requires Controlled::has_problem { return evaluator_.problem(); }
  /// The evaluator of the problem, or the one given.
  Evaluator& evaluator() noexcept { return evaluator_; }
  /// The evaluator.
  const Evaluator& evaluator() const noexcept { return evaluator_; }
  /// The solver in use.
  const Solver& solver() const noexcept { return *solver_; }
  /// The options given; null with a solver of your own.
  const SolverOptions* options() const noexcept { return options_.get(); }
  /// The bounds of the inputs: those that the problem stated at construction, narrowed by the options.
  const InputBounds& bounds() const noexcept { return bounds_; }

  /// Resets the solver, with random numbers from `seed`, and the inputs to those before the first solve.
  /// States and cost of the last plan remain until a solve from a finite state; the problem is not changed.
  void reset(std::uint64_t seed) noexcept {
    solver_->reset(seed);
    rest();
  }
  /// Draws the noise of the next solve ahead, outside its deadline. Has an effect with `mppi`, `svg_mppi` and
  /// `dial_mpc` only (see Solver::prepare).
  void prepare() noexcept { solver_->prepare(); }

 private:
  static std::unique_ptr<Solver> checked(std::unique_ptr<Solver> solver) {
    if (!solver) throw std::invalid_argument("solver: must not be null");
    if (solver->inputs() != input_count) {
      throw std::invalid_argument("solver: is made for " + std::to_string(solver->inputs()) +
                                  " inputs, must be made for the problem's " + std::to_string(input_count));
    }
    return solver;
  }

  /// The bounds that the problem states, narrowed by those of the options.
  static InputBounds bounds_of(const Evaluator& evaluator, const SolverOptions* options) {
    InputBounds bounds;
    if constexpr (Controlled::has_problem) {
      bounds = detail::stated_bounds(evaluator.problem());
    } else {
      bounds = InputBounds(input_count);
    }
    if (!options) return bounds;
    const PerInput &low = bound(*options, "input_min"), &high = bound(*options, "input_max");
    for (int i = 0; i < input_count; ++i) {  // the solver's own check reports values that do not fit
      const auto at = static_cast<std::size_t>(i);
      if (low.fits(input_count)) bounds.low[at] = std::max(low[i], bounds.low[at]);
      if (high.fits(input_count)) bounds.high[at] = std::min(high[i], bounds.high[at]);
    }
    return bounds;
  }

  static const PerInput& bound(const SolverOptions& options, const char* name) {
    if (const PerInput* found = options.find<PerInput>(name)) return *found;
    throw std::invalid_argument(std::string(options.method()) + "." + name +
                                ": missing; the options of a method must have this PerInput");
  }

  /// The options with their bounds narrowed to the problem's.
  SolverOptions within_bounds(SolverOptions options) const {
    PerInput &low = *options.find<PerInput>("input_min"), &high = *options.find<PerInput>("input_max");
    if (low.fits(input_count)) low = bounds_.low;
    if (high.fits(input_count)) high = bounds_.high;
    if constexpr (Controlled::in_levels)
      scale_variances(options, input_count,
                      [this](int input) { return detail::unit_variance(evaluator_.problem(), input); });
    return options;
  }

  void allocate() {
    solver_->connect(evaluator_);
    const auto steps = static_cast<std::size_t>(solver_->horizon());
    inputs_.resize(steps);
    rest();
    if constexpr (Controlled::predicts) {
      states_.resize(steps + 1);
    } else {
      alone_ = SequenceBatch(solver_->horizon(), input_count, 1);
      alone_cost_ = AlignedBuffer(alone_.stride());
      alone_collided_.resize(static_cast<std::size_t>(alone_.stride()));
    }
  }

  /// Sets all inputs to the values within the bounds that are nearest to 0.
  void rest() noexcept {
    for (int i = 0; i < input_count; ++i) previous_[i] = bounds_.nearest(static_cast<std::size_t>(i), 0);
    std::fill(inputs_.begin(), inputs_.end(), previous_);
    given_ = previous_;
    if constexpr (Controlled::in_levels) hold_input_rates(problem(), {}, inputs_.data(), solver_->horizon());
    told_ = true;
  }

  /// The final check of the inputs.
  void check_plan_inputs() noexcept {
    Inputs before = previous_;
    const auto reach = [this](std::size_t input) { return input_step(input); };
    for (Inputs& u : inputs_) corrections_ += check_inputs(u.value, before.value, bounds_, reach);
  }

  /// Returns the largest change of an input in a step; infinite if the evaluator states none.
  double input_step([[maybe_unused]] std::size_t input) const noexcept {
    if constexpr (Controlled::has_problem) {
      return detail::input_step(evaluator_.problem(), static_cast<int>(input));
    } else {
      return std::numeric_limits<double>::infinity();
    }
  }

  /// The final check of cost and states. A cost that is not finite becomes the largest double; a state that
  /// is not finite becomes the state before it. Returns true if all were finite.
  bool check_prediction(const State& x) noexcept {
    int changed = check_cost(cost_.value);
    for (CostTerm& term : terms_) changed += check_cost(term.value);
    const State* last = &x;
    for (State& state : states_) {
      if (!finite(state)) state = *last, ++changed;
      last = &state;
    }
    corrections_ += changed;
    return changed == 0;
  }

  /// Predicts the states under the plan's inputs, and their cost.
  void predict_plan(const State& x) noexcept {
    const int steps = solver_->horizon();
    if constexpr (!StateEvaluator<P>) {
      cost_ = predict(evaluator_.problem(), x, inputs_.data(), steps, states_.data(), &terms_);
    } else {
      if constexpr (Controlled::predicts) {
        cost_ = evaluator_.predict(x, inputs_.data(), steps, states_.data());
      } else {
        for (int row = 0; row < alone_.rows(); ++row) {
          const Inputs& u = inputs_[static_cast<std::size_t>(row / input_count)];
          alone_.data(row)[0] = static_cast<float>(u[row % input_count]);
        }
        evaluator_.evaluate(alone_, 0, 1, alone_cost_.data(), alone_collided_.data());
        cost_ = {static_cast<double>(alone_cost_[0]), alone_collided_[0] != 0};
      }
      terms_[0].value = cost_.value;
    }
  }

  Plan<P> plan(Status status) const noexcept {
    return {status, inputs_, states_, cost_.value, cost_.collided, terms_, solver_->result(), corrections_};
  }

  /// Determines the input that is being applied: that of `set_previous_input`, or else the last plan's input
  /// `elapsed` (s) after it was made.
  /// For a problem with levels, the remainder that is left then.
  void recall_input(double elapsed) noexcept {
    const double step = evaluator_.time_step();
    const double last = static_cast<double>(inputs_.size() - 1);
    if constexpr (Controlled::in_levels) {
      const int applied = step > 0 ? saturate_cast<int>(std::min(std::round(elapsed / step), last)) : 0;
      if (!std::exchange(told_, false))
        carry_remainder(problem(), solver_->result().inputs.data(), inputs_.data(), applied, previous_);
      else
        previous_ = {};
      return;
    }
    const double now = step > 0 && elapsed > step ? std::min(std::round(elapsed / step) - 1, last) : 0;
    previous_ = inputs_[saturate_cast<std::size_t>(now)];
    if (!std::exchange(told_, false)) return;
    for (int i = 0; i < input_count; ++i) {
      const double value = bounds_.nearest(static_cast<std::size_t>(i), given_[i]);
      if (std::isfinite(given_[i])) previous_[i] = value;
      corrections_ += value != given_[i];
    }
  }

  static bool finite(const State& x) noexcept {
    double values[sizeof(State) / sizeof(double)];
    std::memcpy(values, &x, sizeof values);
    return std::all_of(std::begin(values), std::end(values), [](double v) { return std::isfinite(v); });
  }

  Evaluator evaluator_;
  InputBounds bounds_;
  std::shared_ptr<const SolverOptions> options_;
  Polymorphic<Solver> solver_;
  std::vector<Inputs> inputs_;
  std::vector<State> states_;
  Cost<double> cost_{0.0, false};
  decltype(Controlled::cost_terms()) terms_ = Controlled::cost_terms();
  Inputs previous_{};    ///< input applied before the last solve, within the bounds
  Inputs given_{};       ///< argument of the last set_previous_input
  bool told_ = true;     ///< whether the next solve uses `given_`
  int corrections_ = 0;  ///< corrections by the final check, in the last solve
  SequenceBatch alone_;  ///< the plan as a batch of one, for an evaluator that does not predict
  AlignedBuffer alone_cost_;
  std::vector<std::uint8_t> alone_collided_;
};

}  // namespace slalom
