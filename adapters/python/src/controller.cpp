#include "controller.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::python {

/// Marks a controller as at work; two threads at once are a mistake that is told.
class Controller::Busy {
 public:
  explicit Busy(std::atomic<bool>& flag) : flag_(flag) {
    if (flag_.exchange(true)) throw std::runtime_error("controller: another thread is at work with it");
  }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  std::atomic<bool>& flag_;
};

namespace {

/// The options with their bounds narrowed to those that the problem states.
SolverOptions within_bounds(const AnyProblem& problem, SolverOptions options) {
  const auto narrow = [&](PerInput& option, auto&& pick) {
    if (!option.fits(problem.inputs())) return;  // the solver's own check will say so
    std::vector<double> values;
    for (int i = 0; i < problem.inputs(); ++i) values.push_back(pick(option[i], i));
    const bool alike = std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; });
    option = alike ? PerInput(values[0]) : PerInput(values);
  };
  std::visit(
      [&](auto& o) {
        narrow(o.input_min, [&](double bound, int i) { return std::max(bound, problem.input_min(i)); });
        narrow(o.input_max, [&](double bound, int i) { return std::min(bound, problem.input_max(i)); });
      },
      options);
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

/// The input that the last plan had for `elapsed` (s) after it was made: what is being applied.
void Controller::recall_input(double elapsed) {
  if (std::exchange(told_, false)) return;
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
  told_ = true;
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
  recall_input(request.elapsed);
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
  told_ = true;
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

namespace {

/// A plan as Python holds it; its arrays are views of the controller's memory.
struct Plan {
  py::object owner;
  std::uint64_t solve;

  Controller& controller() const {
    auto& c = owner.cast<Controller&>();
    if (c.solves() != solve)
      throw std::runtime_error("plan: the controller has solved again; copy what is to be kept");
    return c;
  }
  const SolveResult& result() const { return controller().result(); }
};

template <class T>
py::array view(const Plan& plan, const T* data, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides = {}) {
  if (strides.empty()) {
    py::array array(py::dtype::of<T>(), shape, data, plan.owner);
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return array;
  }
  py::array array(py::dtype::of<T>(), shape, strides, data, plan.owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// [step][input] values as an array (steps, inputs); empty where there are none.
py::array sequence(const Plan& plan, std::span<const float> values) {
  const py::ssize_t inputs = plan.controller().solver().inputs();
  return view(plan, values.data(), {static_cast<py::ssize_t>(values.size()) / inputs, inputs});
}

py::array sequences(const Plan& plan, const SequenceList& list) {
  const Solver& solver = plan.controller().solver();
  return view(plan, list.values.data(), {list.sequences, solver.horizon(), solver.inputs()});
}

template <class T>
py::array values(const Plan& plan, std::span<const T> list) {
  return view(plan, list.data(), {static_cast<py::ssize_t>(list.size())});
}

/// Per-sample values without their padding.
template <class T>
py::array per_sample(const Plan& plan, std::span<const T> list) {
  const SequenceBatch* samples = plan.result().samples;
  const std::size_t count = samples ? static_cast<std::size_t>(samples->samples()) : list.size();
  return values(plan, list.first(std::min(count, list.size())));
}

py::array samples(const Plan& plan) {
  const SequenceBatch* batch = plan.result().samples;
  if (!batch) return view<float>(plan, nullptr, {0, 0, 0});
  constexpr py::ssize_t width = sizeof(float);
  const py::ssize_t row = width * batch->stride();
  return view(plan, batch->row(0, 0), {batch->samples(), batch->steps(), batch->inputs()},
              {width, row * batch->inputs(), row});
}

py::dict times(const Plan& plan) {
  const StageTimes& t = plan.result().times;
  py::dict all;
  all["draw"] = t.draw;
  all["evaluate"] = t.evaluate;
  all["guide"] = t.guide;
  all["update"] = t.update;
  all["total"] = t.total;
  return all;
}

void bind_plan(py::module_& module) {
  py::class_<Plan>(
      module, "Plan",
      "What a controller wants to do. Arrays are views of the controller's memory, valid until it "
      "solves again; copy what is to be kept.")
      .def_property_readonly(
          "status", [](const Plan& p) { return std::string(name(p.controller().status())); },
          "'ok', 'deadline', 'all_collided', 'degenerate' or 'non_finite_state'")
      .def_property_readonly(
          "ok", [](const Plan& p) { return p.controller().status() == Status::ok; },
          "whether it was solved as asked")
      .def_property_readonly(
          "inputs",
          [](const Plan& p) {
            Controller& c = p.controller();
            return view(p, c.inputs().data(), {c.solver().horizon(), c.solver().inputs()});
          },
          "float64 [horizon, inputs]; the first row is for now")
      .def_property_readonly(
          "states",
          [](const Plan& p) {
            Controller& c = p.controller();
            return view(p, c.prediction().states.data(), {c.solver().horizon() + 1, c.problem().states()});
          },
          "float64 [horizon + 1, states] that the inputs are predicted to lead to")
      .def_property_readonly(
          "cost", [](const Plan& p) { return p.controller().prediction().cost; }, "of the plan")
      .def_property_readonly(
          "collided", [](const Plan& p) { return p.controller().prediction().collided; },
          "whether the plan collides")
      .def_property_readonly(
          "cost_terms",
          [](const Plan& p) {
            py::dict all;
            for (const auto& [name, value] : p.controller().prediction().terms) all[py::str(name)] = value;
            return all;
          },
          "what the cost of the plan is made of, by name; they sum to it")
      .def_property_readonly(
          "nominal", [](const Plan& p) { return sequence(p, p.result().nominal); },
          "float32 [horizon, inputs]; svg_mppi: the best guide")
      .def_property_readonly(
          "variances", [](const Plan& p) { return sequence(p, p.result().variances); },
          "float32 [horizon, inputs], variances of the distribution")
      .def_property_readonly("samples", samples, "float32 [samples, horizon, inputs] drawn last")
      .def_property_readonly(
          "costs", [](const Plan& p) { return per_sample(p, p.result().costs); }, "float32 [samples]")
      .def_property_readonly(
          "weights", [](const Plan& p) { return per_sample(p, p.result().weights); },
          "float32 [samples]; they sum to 1")
      .def_property_readonly(
          "samples_collided", [](const Plan& p) { return per_sample(p, p.result().collided); },
          "uint8 [samples], 1 where a sample collides")
      .def_property_readonly(
          "guides", [](const Plan& p) { return sequences(p, p.result().guides); },
          "float32 [guides, horizon, inputs] where the guides ended")
      .def_property_readonly(
          "guide_path", [](const Plan& p) { return sequences(p, p.result().guide_path); },
          "float32 [iterations x guides, horizon, inputs]")
      .def_property_readonly(
          "minimum_cost", [](const Plan& p) { return p.result().minimum_cost; }, "the least cost of a sample")
      .def_property_readonly(
          "expected_cost", [](const Plan& p) { return p.result().expected_cost; },
          "weighted mean of the samples' costs")
      .def_property_readonly(
          "effective_sample_size", [](const Plan& p) { return p.result().effective_sample_size; },
          "1 / sum of squared weights")
      .def_property_readonly(
          "collided_share", [](const Plan& p) { return p.result().collided_share; },
          "of the samples, 0 ... 1")
      .def_property_readonly(
          "iterations", [](const Plan& p) { return p.result().iterations; },
          "guide or distribution updates made")
      .def_property_readonly("times", times, "s of wall clock by stage");
}

const char* const class_names[] = {"Mppi", "SvgMppi", "ReverseMppi", "SvMpc", "Cem"};
static_assert(std::size(class_names) == std::variant_size_v<SolverOptions>);

template <class Options>
struct Method : Controller {
  Method(const AnyProblem& problem, const Options& options) : Controller(problem, options) {}
};

template <class Options>
void bind_method(py::module_& module, const char* class_name) {
  const std::string method = solver_name(SolverOptions(Options{}));
  const std::string text =
      "A controller that solves its problem with `" + method +
      "`.\n\nThe problem is copied: `controller.problem` is the copy, whose parameters may "
      "change between solves. Keyword arguments with their defaults:\n\n" +
      options_text(Options{});
  py::class_<Method<Options>, Controller>(module, class_name, text.c_str())
      .def(py::init([method](const AnyProblem& problem, const py::kwargs& keywords) {
             Options options;
             set_from_keywords(options, keywords, method);
             return std::make_unique<Method<Options>>(problem, options);
           }),
           py::arg("problem"));
}

template <std::size_t... I>
void bind_methods(py::module_& module, std::index_sequence<I...>) {
  (bind_method<std::variant_alternative_t<I, SolverOptions>>(module, class_names[I]), ...);
}

}  // namespace

void bind_controllers(py::module_& module) {
  bind_plan(module);
  py::class_<Controller>(module, "Controller", "What all controllers have in common.")
      .def(
          "solve",
          [](const py::object& self, std::vector<double> state, double elapsed, double deadline) {
            auto& controller = self.cast<Controller&>();
            controller.solve(self, std::move(state), {elapsed, deadline});
            return Plan{self, controller.solves()};
          },
          py::arg("state"), py::arg("elapsed") = 0.0,
          py::arg("deadline") = std::numeric_limits<double>::infinity(),
          "The plan from `state`. `elapsed` (s) since the last solve shifts the warm start; within "
          "`deadline` "
          "(s) what is best so far is returned.")
      .def("reset", &Controller::reset, py::arg("seed") = 0,
           "Forgets everything and starts the random numbers anew.")
      .def("set_previous_input", &Controller::set_previous_input, py::arg("input"),
           "Tells a problem with bounds on its input rates what was applied before the next solve; unless "
           "told, it is what the last plan had for then.")
      .def("prepare", &Controller::prepare, "Draws the noise of the next solve ahead, outside its deadline.")
      .def_property_readonly("problem", &Controller::problem, py::return_value_policy::reference_internal,
                             "the controller's copy of its problem; its parameters may change between solves")
      .def_property_readonly(
          "method", [](const Controller& c) { return std::string(c.solver().name()); },
          "the name of the method")
      .def_property_readonly(
          "horizon", [](const Controller& c) { return c.solver().horizon(); }, "steps")
      .def_property_readonly(
          "options",
          [](const Controller& c) {
            py::dict all;
            std::visit(
                [&](const auto& options) {
                  for (const OptionEntry& entry : list_options(options))
                    all[entry.declaration.name] = to_python(entry.value);
                },
                c.options());
            return all;
          },
          "the options in use, by name");
  bind_methods(module, std::make_index_sequence<std::variant_size_v<SolverOptions>>{});
  module.def(
      "methods",
      [] {
        const auto all = solver_names();
        return std::vector<std::string>(all.begin(), all.end());
      },
      "The names of all methods.");
  module.def(
      "options",
      [](const std::string& method) {
        return std::visit([](const auto& options) { return describe_options(options); },
                          solver_options(method));
      },
      py::arg("method"), "What can be set of a method: a dictionary for each option.");
}

}  // namespace slalom::python
