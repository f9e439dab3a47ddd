#include "controller.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <limits>
#include <thread>

namespace slalom::python {

namespace {

/// A number as Python prints it.
std::string text_of(double value) {
  return py::str(py::float_(value));
}

/// Warns with slalom.SymptomWarning. Throws if the program's warning filter turns it into an error.
void warn(const std::string& text) {
  const py::object category = py::module_::import("slalom").attr("SymptomWarning");
  if (PyErr_WarnEx(category.ptr(), text.c_str(), 2) != 0) throw py::error_already_set();
}

/// Throws std::invalid_argument if a time of the request is not one, or if the problem cannot use it.
void check_times(const SolveRequest& request, double time_step, int horizon) {
  if (!(request.elapsed >= 0 && std::isfinite(request.elapsed)))
    throw std::invalid_argument("elapsed: " + text_of(request.elapsed) + " must be finite and at least 0");
  if (request.elapsed > 0 && !(time_step > 0))
    throw std::invalid_argument(
        "elapsed: the problem has no dt (the duration of its steps, s): make it with dt=..., or omit "
        "elapsed");
  if (!(request.deadline >= 0))
    throw std::invalid_argument("deadline: " + text_of(request.deadline) + " must be at least 0");
  if (request.elapsed > horizon * time_step)
    warn("elapsed: " + text_of(request.elapsed) + " s is longer than the horizon of " +
         text_of(horizon * time_step) +
         " s, so nothing of the last plan is left; it is the time since the last solve, in seconds");
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
      nan_costs_ +=
          std::count_if(costs + first, costs + first + count, [](float c) { return std::isnan(c); });
    }
  }
  /// The costs so far that were nan.
  std::int64_t nan_costs() const noexcept { return nan_costs_; }
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
  mutable std::atomic<std::int64_t> nan_costs_ = 0;
};

/// Makes a solver. With callables a batch takes as long as its calls, so svg_mppi then has few.
std::unique_ptr<Solver> make_for(const AnyProblem& problem, SolverOptions options) {
  int* const batches = options.find<int>("batches");
  if (batches && *batches == 0 && *options.find<int>("samples") >= 64 && problem.evaluator().whole_batches())
    *batches = 3;
  return make_solver(options, problem.inputs());
}

}  // namespace

Controller::Controller(const AnyProblem& problem, const SolverOptions& options, bool on_gpu)
    : problem_(problem.clone()),
      options_(ControllerCore::within_bounds(problem, options)),
      on_gpu_(on_gpu),
      core_(*problem_, options,
            [&](const SolverOptions& narrowed) {
              return on_gpu ? problem_->gpu_solver(narrowed) : make_for(problem, narrowed);
            }),
      state_(static_cast<std::size_t>(problem.states())) {}

/// Marks the controller as in use. Throws std::runtime_error if another thread uses it.
Controller::Busy Controller::use() {
  if (usage_.busy.exchange(true)) throw std::runtime_error("controller: another thread is using it");
  return Busy(&usage_.busy);
}

void Controller::set_previous_input(const std::vector<double>& input) {
  checked(input, static_cast<std::size_t>(problem_->inputs()), "input");
  for (const double value : input)
    if (!std::isfinite(value)) throw std::invalid_argument("input: " + text_of(value) + " must be finite");
  const Busy busy = use();
  core_.set_previous_input(input);
  is_new_ = false;
}

/// Prepares a solve. Returns false, and the plan remains, if the state is not finite.
bool Controller::start(py::handle owner, std::vector<double> state, const SolveRequest& request) {
  ++solves_;
  is_new_ = false;
  if (!core_.begin(*problem_, state, request)) return false;
  state_ = std::move(state);
  prediction_.reset();
  problem_->begin(owner.ptr());
  return true;
}

/// Takes the plan from the solver, of whose samples some had a cost of nan. Rethrows a callable's exception.
void Controller::finish(std::int64_t nan_costs) {
  core_.finish(*problem_);
  problem_->finish();
  nan_costs_ = static_cast<int>(std::min<std::int64_t>(nan_costs, std::numeric_limits<int>::max() / 2));
  if (nan_costs > 0 && !std::exchange(told_of_nan_, true))
    warn("cost: nan for " + std::to_string(nan_costs) +
         " samples of this solve, which get no weight: dynamics and cost must return numbers; inf marks a "
         "sample that must not be chosen");
  if (solves_ == 1) check_repeats();
  // A robot that has arrived makes no progress, either, and many a task takes all that the inputs can do.
  if (result().suspicious_solves == SolveResult::symptom_patience &&
      result().suspicion < Symptom::saturated_inputs)
    warn(std::string(name(result().suspicion)) + " in " + std::to_string(SolveResult::symptom_patience) +
         " solves in a row: " + explanation(result().suspicion));
}

/// Warns if callables return other values for the same arguments.
void Controller::check_repeats() {
  if (!problem_->evaluator().whole_batches()) return;
  const auto inputs = core_.inputs().first(static_cast<std::size_t>(problem_->inputs()));
  const Prediction first = problem_->predict(state_, inputs), again = problem_->predict(state_, inputs);
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  if (!same(first.cost, again.cost) || !std::ranges::equal(first.states, again.states, same))
    warn(
        "dynamics, cost: return other values for the same arguments, so samples are compared by chance: "
        "leave random numbers out, and use slalom.RiskEvaluator for disturbances");
}

void Controller::solve(const std::vector<py::handle>& owners, std::vector<std::vector<double>> states,
                       const SolveRequest& request, int threads) {
  std::vector<Controller*> all;
  std::vector<Busy> busy;
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (!py::isinstance<Controller>(owners[i]) || !is_constructed(owners[i].ptr()))
      throw py::type_error("controller: " + py::repr(py::type::handle_of(owners[i])).cast<std::string>() +
                           " is no Controller, or its __init__ has not been called");
    all.push_back(&owners[i].cast<Controller&>());
    checked(states[i], static_cast<std::size_t>(all[i]->problem_->states()), "state");
    check_times(request, all[i]->problem_->evaluator().time_step(), all[i]->solver().horizon());
    busy.push_back(all[i]->use());
  }
  // Threads that hand the interpreter lock to each other take longer than one thread.
  const bool calls_python = std::any_of(all.begin(), all.end(), [](const Controller* each) {
    return each->problem_->evaluator().whole_batches();
  });
  ThreadPool pool(calls_python && threads > 1 ? 1 : threads);
  std::vector<Controller*> started;
  for (std::size_t i = 0; i < owners.size(); ++i)
    if (all[i]->start(owners[i], std::move(states[i]), request)) started.push_back(all[i]);
  std::deque<Interruptible> rollouts;
  for (Controller* each : started) rollouts.emplace_back(each->problem_->evaluator());
  {
    const py::gil_scoped_release unlock;
    pool.run(static_cast<int>(started.size()), [&](int i) {
      const auto at = static_cast<std::size_t>(i);
      Controller& each = *started[at];  // a GPU takes the problem itself, and a second at most
      each.core_.solve(*each.problem_, each.on_gpu_ ? each.problem_->evaluator() : rollouts[at], request);
    });
  }
  std::exception_ptr first;
  for (std::size_t i = 0; i < started.size(); ++i) {
    try {
      started[i]->finish(rollouts[i].nan_costs());
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
  core_.reset(*problem_, seed);
}

void Controller::prepare() {
  const Busy busy = use();
  const py::gil_scoped_release unlock;
  core_.solver().prepare();
}

Prediction& Controller::prediction() {
  if (!prediction_) {
    prediction_ = problem_->predict(state_, core_.inputs());
    core_.check_cost(prediction_->cost);
    for (auto& [name, value] : prediction_->terms) core_.check_cost(value);
    core_.check_states(state_, prediction_->states);
  }
  return *prediction_;
}

}  // namespace slalom::python
