#include "controller.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <limits>
#include <thread>

#include "slalom/core/final_check.hpp"

namespace slalom::python {

namespace {

/// The options with bounds narrowed to the problem's. Throws std::invalid_argument if one of these is nan.
SolverOptions within_bounds(const AnyProblem& problem, SolverOptions options) {
  const auto narrow = [&](PerInput& option, auto&& pick) {
    if (!option.fits(problem.inputs())) return;  // the solver reports the error
    std::vector<double> values;
    for (int i = 0; i < problem.inputs(); ++i) {
      if (std::isnan(problem.input_min(i)) || std::isnan(problem.input_max(i)))
        throw std::invalid_argument("Problem.input_min, Problem.input_max: nan must be a number");
      values.push_back(pick(option[i], i));
    }
    const bool equal = std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; });
    option = equal ? PerInput(values[0]) : PerInput(values);
  };
  narrow(*options.find<PerInput>("input_min"),
         [&](double bound, int i) { return std::max(bound, problem.input_min(i)); });
  narrow(*options.find<PerInput>("input_max"),
         [&](double bound, int i) { return std::min(bound, problem.input_max(i)); });
  return options;
}

/// The options with variances in the units of the problem's inputs.
SolverOptions scaled(const AnyProblem& problem, SolverOptions options) {
  bool other = false;
  for (int i = 0; i < problem.inputs(); ++i) other = other || problem.unit_variance(i) > 0;
  if (other)
    scale_variances(options, problem.inputs(), [&](int input) { return problem.unit_variance(input); });
  return options;
}

/// The bounds of every input, once the solver has checked them.
InputBounds bounds_of(const SolverOptions& options, int inputs) {
  InputBounds bounds(inputs);
  for (int i = 0; i < inputs; ++i) {
    bounds.low[static_cast<std::size_t>(i)] = (*options.find<PerInput>("input_min"))[i];
    bounds.high[static_cast<std::size_t>(i)] = (*options.find<PerInput>("input_max"))[i];
  }
  return bounds;
}

/// A number as Python prints it.
std::string text_of(double value) {
  return py::str(py::float_(value));
}

/// Throws std::invalid_argument if a time of the request is not one, or if the problem cannot use it.
void check_times(const SolveRequest& request, double time_step) {
  if (!(request.elapsed >= 0 && std::isfinite(request.elapsed)))
    throw std::invalid_argument("elapsed: " + text_of(request.elapsed) + " must be finite and at least 0");
  if (request.elapsed > 0 && !(time_step > 0))
    throw std::invalid_argument(
        "elapsed: the problem has no dt (the duration of its steps, s): make it with dt=..., or omit "
        "elapsed");
  if (!(request.deadline >= 0))
    throw std::invalid_argument("deadline: " + text_of(request.deadline) + " must be at least 0");
}

/// Warns with slalom.SymptomWarning. Throws if the program's warning filter turns it into an error.
void warn_of(Symptom symptom) {
  const py::object category = py::module_::import("slalom").attr("SymptomWarning");
  const std::string text = std::string(name(symptom)) + " in " +
                           std::to_string(SolveResult::symptom_patience) +
                           " solves in a row: " + explanation(symptom);
  if (PyErr_WarnEx(category.ptr(), text.c_str(), 2) != 0) throw py::error_already_set();
}

/// Rollouts that end at once after a handler of a signal has raised an exception. Handlers run in the main
/// thread, so the thread that solves lets them run, every 50 ms.
class Interruptible final : public BatchEvaluator {
 public:
  explicit Interruptible(const BatchEvaluator& rollouts) : rollouts_(rollouts) {}

  int inputs() const noexcept override { return rollouts_.inputs(); }
  double time_step() const noexcept override { return rollouts_.time_step(); }
  bool whole_batches() const noexcept override { return rollouts_.whole_batches(); }
  const Sampler* sampler() const noexcept override { return rollouts_.sampler(); }
  void evaluate(const SequenceBatch& batch, int first, int count, float* costs,
                std::uint8_t* collided) const noexcept override {
    if (std::this_thread::get_id() == solving_ && !stopped_ && Clock::now() >= next_) let_handlers_run();
    if (stopped_) {
      std::fill_n(costs + first, count, std::numeric_limits<float>::infinity());
    } else {
      rollouts_.evaluate(batch, first, count, costs, collided);
    }
  }
  /// The exception that a handler raised, or null.
  const std::exception_ptr& raised() const noexcept { return raised_; }

 private:
  using Clock = std::chrono::steady_clock;

  void let_handlers_run() const noexcept {
    try {
      check_signals();
    } catch (...) {
      raised_ = std::current_exception();
      stopped_ = true;
    }
    next_ = Clock::now() + period;
  }

  static constexpr std::chrono::milliseconds period{50};
  const BatchEvaluator& rollouts_;
  std::thread::id solving_ = std::this_thread::get_id();
  mutable Clock::time_point next_ = Clock::now() + period;
  mutable std::exception_ptr raised_;
  mutable std::atomic<bool> stopped_ = false;
};

}  // namespace

Controller::Controller(const AnyProblem& problem, const SolverOptions& options, bool on_gpu)
    : problem_(problem.clone()),
      options_(within_bounds(problem, options)),
      on_gpu_(on_gpu),
      solver_(on_gpu ? problem_->gpu_solver(scaled(problem, options_))
                     : make_solver(scaled(problem, options_), problem.inputs())),
      bounds_(bounds_of(options_, problem.inputs())),
      state_(static_cast<std::size_t>(problem.states())),
      inputs_(static_cast<std::size_t>(solver_->horizon() * solver_->inputs())),
      previous_(static_cast<std::size_t>(problem.inputs())) {
  solver_->connect(problem_->evaluator());
  rest();
}

/// Marks the controller as in use. Throws std::runtime_error if another thread uses it.
Controller::Busy Controller::use() {
  if (usage_.busy.exchange(true)) throw std::runtime_error("controller: another thread is using it");
  return Busy(&usage_.busy);
}

/// Sets the state before the first solve: every input at the value in its bounds that is nearest to 0.
void Controller::rest() {
  for (std::size_t i = 0; i < previous_.size(); ++i) previous_[i] = bounds_.nearest(i, 0);
  for (std::size_t i = 0; i < inputs_.size(); ++i) inputs_[i] = previous_[i % previous_.size()];
  previous_known_ = true;
}

/// Sets the previous input to that of the last plan `elapsed` (s) after it was made, unless the user set it.
void Controller::update_previous_input(double elapsed) {
  if (std::exchange(previous_known_, false)) return;
  const double step = problem_->evaluator().time_step(), last = solver_->horizon() - 1;
  const double applied = step > 0 ? std::min(std::round(elapsed / step), last) : 0;
  const auto values = static_cast<std::size_t>(applied) * previous_.size();
  if (problem_->carry(result().inputs.first(values), std::span(inputs_).first(values), previous_)) return;
  const double now = step > 0 && elapsed > step ? std::min(std::round(elapsed / step) - 1, last) : 0;
  const auto at = inputs_.begin() + static_cast<std::ptrdiff_t>(now) * solver_->inputs();
  std::copy_n(at, previous_.size(), previous_.begin());
}

void Controller::set_previous_input(std::vector<double> input) {
  if (input.size() != previous_.size())
    throw std::invalid_argument("input: has " + std::to_string(input.size()) + " values, must have " +
                                std::to_string(previous_.size()));
  for (const double value : input)
    if (!std::isfinite(value)) throw std::invalid_argument("input: " + text_of(value) + " must be finite");
  const Busy busy = use();
  for (std::size_t i = 0; i < input.size(); ++i) previous_[i] = bounds_.nearest(i, input[i]);
  is_new_ = false;
  previous_known_ = true;
}

void Controller::check(const std::vector<double>& state, const SolveRequest& request) const {
  if (static_cast<int>(state.size()) != problem_->states())
    throw std::invalid_argument("state: has " + std::to_string(state.size()) + " values, must have " +
                                std::to_string(problem_->states()));
  check_times(request, problem_->evaluator().time_step());
}

/// Prepares a solve. Returns false, and the plan remains, if the state is not finite.
bool Controller::start(py::handle owner, std::vector<double> state, double elapsed) {
  ++solves_;
  is_new_ = false;
  corrections_ = 0;
  if (!std::all_of(state.begin(), state.end(), [](double v) { return std::isfinite(v); })) {
    status_ = Status::non_finite_state;
    return false;
  }
  state_ = std::move(state);
  prediction_.reset();
  update_previous_input(elapsed);
  problem_->set_state(state_);
  problem_->set_previous_input(previous_);
  problem_->begin(owner.ptr());
  return true;
}

/// Takes the plan from the solver. Rethrows the exception of a callable.
void Controller::finish() {
  std::copy(result().inputs.begin(), result().inputs.end(), inputs_.begin());
  problem_->hold_rates(previous_, inputs_);
  std::vector<double> before = previous_;
  const auto any = [](std::size_t) { return std::numeric_limits<double>::infinity(); };  // rates hold by now
  for (std::size_t at = 0; at < inputs_.size(); at += before.size())
    corrections_ += check_inputs(std::span(inputs_).subspan(at, before.size()), before, bounds_, any);
  status_ = result().status;
  problem_->finish();
  // A robot that has arrived makes no progress, either: not worth a warning.
  if (result().suspicious_solves == SolveResult::symptom_patience &&
      result().suspicion != Symptom::no_progress)
    warn_of(result().suspicion);
}

void Controller::solve(const std::vector<py::handle>& owners, std::vector<std::vector<double>> states,
                       const SolveRequest& request, int threads) {
  std::vector<Controller*> all;
  std::vector<Busy> busy;
  for (std::size_t i = 0; i < owners.size(); ++i) {
    all.push_back(owners[i].cast<Controller*>());
    all[i]->check(states[i], request);
    busy.push_back(all[i]->use());
  }
  // Threads that hand the interpreter lock to each other take longer than one thread.
  const bool calls_python = std::any_of(all.begin(), all.end(), [](const Controller* each) {
    return each->problem_->evaluator().whole_batches();
  });
  ThreadPool pool(calls_python && threads > 1 ? 1 : threads);
  std::vector<Controller*> started;
  for (std::size_t i = 0; i < owners.size(); ++i)
    if (all[i]->start(owners[i], std::move(states[i]), request.elapsed)) started.push_back(all[i]);
  std::deque<Interruptible> rollouts;
  for (Controller* each : started) rollouts.emplace_back(each->problem_->evaluator());
  {
    const py::gil_scoped_release unlock;
    pool.run(static_cast<int>(started.size()), [&](int i) {
      const auto at = static_cast<std::size_t>(i);
      Controller& each = *started[at];  // a GPU takes the problem itself, and a second at most
      each.solver_->solve(each.on_gpu_ ? each.problem_->evaluator() : rollouts[at], request);
    });
  }
  std::exception_ptr first;
  for (Controller* each : started) {
    try {
      each->finish();
    } catch (...) {
      if (!first) first = std::current_exception();
    }
  }
  for (const Interruptible& each : rollouts)
    if (each.raised()) first = each.raised();
  if (first) std::rethrow_exception(first);
}

std::unique_ptr<Controller> Controller::copy() {
  const Busy busy = use();
  return std::unique_ptr<Controller>(new Controller(*this));
}

void Controller::reset(std::uint64_t seed) {
  const Busy busy = use();
  ++solves_;
  is_new_ = false;
  solver_->reset(seed);
  rest();
}

void Controller::prepare() {
  const Busy busy = use();
  const py::gil_scoped_release unlock;
  solver_->prepare();
}

Prediction& Controller::prediction() {
  if (!prediction_) {
    prediction_ = problem_->predict(state_, inputs_);
    int changed = check_cost(prediction_->cost);
    for (auto& [name, value] : prediction_->terms) changed += check_cost(value);
    corrections_ += changed;
    if (changed > 0) status_ = Status::degenerate;
  }
  return *prediction_;
}

}  // namespace slalom::python
