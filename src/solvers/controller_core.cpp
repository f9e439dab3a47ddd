#include "slalom/solvers/controller_core.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom {
namespace {

bool finite(std::span<const double> values) noexcept {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

template <class Options>
auto& bound(Options& options, const char* name) {
  if (auto* found = options.template find<PerInput>(name)) return *found;
  throw std::invalid_argument(std::string(options.method()) + "." + name +
                              ": missing; the options of a method must have this PerInput");
}

/// The bounds that the problem states, narrowed by those of the options.
InputBounds narrowed_bounds(const ControlledProblem& problem, const SolverOptions& options) {
  InputBounds bounds = problem.stated_bounds();
  const PerInput &low = bound(options, "input_min"), &high = bound(options, "input_max");
  for (int i = 0; i < problem.inputs(); ++i) {  // the solver's own check reports values that do not fit
    const auto at = static_cast<std::size_t>(i);
    if (low.fits(problem.inputs())) bounds.low[at] = std::max(low[i], bounds.low[at]);
    if (high.fits(problem.inputs())) bounds.high[at] = std::min(high[i], bounds.high[at]);
  }
  return bounds;
}

/// Multiplies the options whose unit is input^2 by the unit of the problem's variances where it has one. A
/// `variance` of 0, which would follow from the bounds, becomes that unit.
SolverOptions with_scaled_variances(const ControlledProblem& problem, SolverOptions options) {
  const int inputs = problem.inputs();
  bool has_unit = false;
  for (int i = 0; i < inputs; ++i) has_unit = has_unit || problem.unit_variance(i) > 0;
  if (!has_unit) return options;
  options.for_each([&](const SolverOptions::OptionPointer& field, const Declaration& declaration) {
    PerInput* const* const option = std::get_if<PerInput*>(&field);
    if (!option || std::string_view(declaration.unit) != "input^2" || !(*option)->fits(inputs)) return;
    std::vector<double> scaled;
    const bool of_samples = std::string_view(declaration.name) == "variance";
    for (int i = 0; i < inputs; ++i) {
      const double given = (**option)[i], unit = problem.unit_variance(i);
      scaled.push_back(unit > 0 ? unit * (given == 0 && of_samples ? 1 : given) : given);
    }
    **option = PerInput(std::move(scaled));
  });
  return options;
}

/// The states near the present one in which a problem may start.
class MovedStates final : public NearbyStates {
 public:
  MovedStates(ControlledProblem& problem, std::span<const double> state, const PredictionErrors& errors,
              std::span<double> moved)
      : problem_(problem), state_(state), errors_(errors), moved_(moved) {}

  int count() const noexcept override { return errors_.count(); }
  void start_at(int index) noexcept override {
    if (index >= 0) errors_.move(state_, index, moved_);
    problem_.set_state(index >= 0 ? moved_ : state_);
  }

 private:
  ControlledProblem& problem_;
  std::span<const double> state_;
  const PredictionErrors& errors_;
  std::span<double> moved_;
};

std::unique_ptr<Solver> checked(std::unique_ptr<Solver> solver, int inputs) {
  if (!solver) throw std::invalid_argument("solver: must not be null");
  if (solver->inputs() != inputs)
    throw std::invalid_argument("solver: is made for " + std::to_string(solver->inputs()) +
                                " inputs, must be made for the problem's " + std::to_string(inputs));
  return solver;
}

}  // namespace

SolverOptions ControllerCore::within_bounds(const ControlledProblem& problem, SolverOptions options) {
  const InputBounds bounds = narrowed_bounds(problem, options);
  const auto narrow = [&](PerInput& option, const std::vector<double>& values) {
    if (!option.fits(problem.inputs())) return;
    const bool equal = std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; });
    option = equal ? PerInput(values[0]) : PerInput(values);
  };
  narrow(bound(options, "input_min"), bounds.low);
  narrow(bound(options, "input_max"), bounds.high);
  return options;
}

ControllerCore::ControllerCore(const ControlledProblem& problem, const SolverOptions& options,
                               const SolverFactory& make)
    : bounds_(narrowed_bounds(problem, options)),
      solver_(make(with_scaled_variances(problem, within_bounds(problem, options)))) {
  connect(problem);
}

ControllerCore::ControllerCore(const ControlledProblem& problem, std::unique_ptr<Solver> solver)
    : bounds_(problem.stated_bounds()), solver_(checked(std::move(solver), problem.inputs())) {
  connect(problem);
}

void ControllerCore::connect(const ControlledProblem& problem) {
  solver_->connect(problem.evaluator());
  const auto inputs = static_cast<std::size_t>(problem.inputs());
  inputs_.resize(static_cast<std::size_t>(solver_->horizon()) * inputs);
  previous_.resize(inputs);
  given_ = before_ = reach_ = previous_;
  state_.resize(static_cast<std::size_t>(problem.states()));
  predicted_ = moved_ = state_;
  errors_ = PredictionErrors(problem.states());
  rest(problem);
}

/// Sets all inputs to the values within the bounds that are nearest to 0.
void ControllerCore::rest(const ControlledProblem& problem) noexcept {
  for (std::size_t i = 0; i < previous_.size(); ++i) previous_[i] = bounds_.nearest(i, 0);
  for (std::size_t at = 0; at < inputs_.size(); ++at) inputs_[at] = previous_[at % previous_.size()];
  set_previous_input(previous_);
  if (!problem.in_levels()) return;
  std::fill(previous_.begin(), previous_.end(), 0);
  problem.hold_rates(previous_, inputs_);
}

bool ControllerCore::begin(ControlledProblem& problem, std::span<const double> state,
                           const SolveRequest& request) noexcept {
  corrections_ = 0;
  status_ = !finite(state)                                           ? Status::non_finite_state
            : !valid_times(request, problem.evaluator().time_step()) ? Status::invalid_time
                                                                     : Status::ok;
  if (status_ != Status::ok) return false;
  if (predict(problem, request.elapsed)) {
    // A value that has not changed at all is one of a frame that moves with the robot.
    for (std::size_t i = 0; i < state.size(); ++i)
      if (state[i] == state_[i]) predicted_[i] = state[i];
    errors_.add(state, predicted_);
  }
  std::copy(state.begin(), state.end(), state_.begin());
  has_state_ = true;
  recall_input(problem, request.elapsed);
  problem.set_state(state);
  problem.set_previous_input(previous_);
  return true;
}

/// Determines the input that is being applied: that of `set_previous_input`, or else the last plan's input
/// `elapsed` (s) after it was made. For a problem with levels, the remainder that is left then.
void ControllerCore::recall_input(const ControlledProblem& problem, double elapsed) noexcept {
  const double step = problem.evaluator().time_step(), last = solver_->horizon() - 1;
  const double applied = step > 0 ? std::round(elapsed / step) : 0;
  const auto first_values = [&](double steps) {
    return saturate_cast<std::size_t>(std::min(steps, last)) * previous_.size();
  };
  const bool told = std::exchange(told_, false);
  if (problem.in_levels()) {
    const std::size_t count = first_values(applied);
    if (told) return std::fill(previous_.begin(), previous_.end(), 0.0);
    return problem.carry(solver_->result().inputs.first(count), std::span(inputs_).first(count), previous_);
  }
  const std::size_t now = first_values(elapsed > step ? applied - 1 : 0);
  for (std::size_t i = 0; i < previous_.size(); ++i) {
    const double value = bounds_.nearest(i, given_[i]);
    previous_[i] = told && std::isfinite(given_[i]) ? value : inputs_[now + i];
    corrections_ += told && value != given_[i];
  }
}

/// Predicts the present state from the start of the last solve. Returns false if that is not possible.
bool ControllerCore::predict(const ControlledProblem& problem, double elapsed) noexcept {
  const double step = problem.evaluator().time_step(), steps = step > 0 ? elapsed / step : 0;
  const double whole = std::round(steps), left = std::abs(steps - whole) < 1e-6 ? whole : steps;
  if (!has_state_ || !(left > 0 && left <= solver_->horizon())) return false;
  const std::size_t inputs = previous_.size();
  predicted_ = state_;
  for (int k = 0; k < left; ++k) {
    moved_ = predicted_;
    const auto at = static_cast<std::size_t>(k) * inputs;
    if (!problem.advance(moved_, std::span(inputs_).subspan(at, inputs), k)) return false;
    for (std::size_t i = 0; i < moved_.size(); ++i)
      predicted_[i] = std::lerp(predicted_[i], moved_[i], std::min(left - k, 1.0));
  }
  return true;
}

void ControllerCore::solve(ControlledProblem& problem, const BatchEvaluator& evaluator,
                           const SolveRequest& request) noexcept {
  MovedStates nearby(problem, state_, errors_, moved_);
  SolveRequest all = request;
  all.nearby = &nearby;
  solver_->solve(evaluator, all);
}

void ControllerCore::finish(const ControlledProblem& problem) noexcept {
  const SolveResult& result = solver_->result();
  status_ = result.status;
  std::copy(result.inputs.begin(), result.inputs.end(), inputs_.begin());
  problem.hold_rates(previous_, inputs_);
  std::copy(previous_.begin(), previous_.end(), before_.begin());
  for (std::size_t i = 0; i < reach_.size(); ++i) reach_[i] = problem.input_step(static_cast<int>(i));
  const auto reach = [this](std::size_t input) { return reach_[input]; };
  for (std::size_t at = 0; at < inputs_.size(); at += before_.size())
    corrections_ += check_inputs(std::span(inputs_).subspan(at, before_.size()), before_, bounds_, reach);
}

void ControllerCore::check_states(std::span<const double> start, std::span<double> states) noexcept {
  int changed = 0;
  for (std::span<const double> last = start; !states.empty(); states = states.subspan(start.size())) {
    const std::span<double> state = states.first(start.size());
    if (!finite(state)) std::copy(last.begin(), last.end(), state.begin()), ++changed;
    last = state;
  }
  correct(changed);
}

void ControllerCore::correct(int changed) noexcept {
  corrections_ += changed;
  if (changed > 0) status_ = Status::degenerate;
}

void ControllerCore::set_previous_input(std::span<const double> u) noexcept {
  std::copy(u.begin(), u.end(), given_.begin());
  told_ = true;
}

void ControllerCore::reset(const ControlledProblem& problem, std::uint64_t seed) noexcept {
  solver_->reset(seed);
  errors_.clear();
  has_state_ = false;
  rest(problem);
}

}  // namespace slalom
