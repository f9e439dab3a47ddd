#include "controller.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::python {

/// Marks a controller as in use. Throws std::runtime_error if another thread uses it.
class Controller::Busy {
 public:
  explicit Busy(std::atomic<bool>& flag) : flag_(flag) {
    if (flag_.exchange(true)) throw std::runtime_error("controller: another thread is using it");
  }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  std::atomic<bool>& flag_;
};

namespace {

/// The options with their bounds narrowed to those of the problem.
SolverOptions within_bounds(const AnyProblem& problem, SolverOptions options) {
  const auto narrow = [&](PerInput& option, auto&& pick) {
    if (!option.fits(problem.inputs())) return;  // the solver reports the error
    std::vector<double> values;
    for (int i = 0; i < problem.inputs(); ++i) values.push_back(pick(option[i], i));
    const bool equal = std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; });
    option = equal ? PerInput(values[0]) : PerInput(values);
  };
  narrow(*options.find<PerInput>("input_min"),
         [&](double bound, int i) { return std::max(bound, problem.input_min(i)); });
  narrow(*options.find<PerInput>("input_max"),
         [&](double bound, int i) { return std::min(bound, problem.input_max(i)); });
  return options;
}

}  // namespace

Controller::Controller(const AnyProblem& problem, const SolverOptions& options)
    : problem_(problem.clone()),
      options_(within_bounds(problem, options)),
      solver_(make_solver(options_, problem.inputs())),
      state_(static_cast<std::size_t>(problem.states())),
      inputs_(static_cast<std::size_t>(solver_->horizon() * solver_->inputs())),
      previous_(static_cast<std::size_t>(problem.inputs())) {}

/// Sets the previous input to that of the last plan, `elapsed` (s) after it was made, unless the caller has
/// set it.
void Controller::update_previous_input(double elapsed) {
  if (std::exchange(previous_known_, false)) return;
  const double step = problem_->evaluator().time_step(), last = solver_->horizon() - 1;
  const double now = step > 0 && elapsed > step ? std::min(std::round(elapsed / step) - 1, last) : 0;
  const auto at = inputs_.begin() + static_cast<std::ptrdiff_t>(now) * solver_->inputs();
  std::copy_n(at, previous_.size(), previous_.begin());
}

void Controller::set_previous_input(std::vector<double> input) {
  if (input.size() != previous_.size())
    throw std::invalid_argument("input: has " + std::to_string(input.size()) + " values, must have " +
                                std::to_string(previous_.size()));
  const Busy busy(busy_);
  previous_ = std::move(input);
  previous_known_ = true;
}

void Controller::solve(py::handle owner, std::vector<double> state, const SolveRequest& request) {
  if (static_cast<int>(state.size()) != problem_->states())
    throw std::invalid_argument("state: has " + std::to_string(state.size()) + " values, must have " +
                                std::to_string(problem_->states()));
  const Busy busy(busy_);
  ++solves_;
  if (!std::all_of(state.begin(), state.end(), [](double v) { return std::isfinite(v); })) {
    status_ = Status::non_finite_state;
    return;
  }
  state_ = std::move(state);
  prediction_.reset();
  update_previous_input(request.elapsed);
  problem_->set_state(state_);
  problem_->set_previous_input(previous_);
  problem_->begin(owner);
  {
    const py::gil_scoped_release unlock;
    result_ = solver_->solve(problem_->evaluator(), request);
  }
  std::copy(result_.inputs.begin(), result_.inputs.end(), inputs_.begin());
  problem_->hold_rates(previous_, inputs_);
  status_ = result_.status;
  problem_->finish();
}

void Controller::reset(std::uint64_t seed) {
  const Busy busy(busy_);
  ++solves_;
  solver_->reset(seed);
  std::fill(previous_.begin(), previous_.end(), 0.0);
  previous_known_ = true;
}

void Controller::prepare() {
  const Busy busy(busy_);
  const py::gil_scoped_release unlock;
  solver_->prepare();
}

Prediction& Controller::prediction() {
  if (!prediction_) prediction_ = problem_->predict(state_, inputs_);
  return *prediction_;
}

}  // namespace slalom::python
