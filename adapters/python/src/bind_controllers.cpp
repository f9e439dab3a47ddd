#include <cmath>
#include <limits>
#include <optional>

#include "controller.hpp"

namespace slalom::python {
namespace {

/// Throws std::invalid_argument unless the solver takes proposals of this shape, or there are none.
void check_proposals(const Solver& solver, const Numbers& proposals) {
  if (proposals.ndim() == 1 && proposals.size() == 0) return;
  if (!solver.takes_proposals())
    throw std::invalid_argument("proposals: the method " + std::string(solver.name()) +
                                " does not accept proposals");
  const py::ssize_t first = proposals.ndim() - 2;
  if ((first != 0 && first != 1) || proposals.shape(first) != solver.horizon() ||
      proposals.shape(first + 1) != solver.inputs()) {
    const std::string one = std::to_string(solver.horizon()) + ", " + std::to_string(solver.inputs());
    throw std::invalid_argument("proposals: have the shape " + shape_text(extents_of(proposals)) +
                                ", must have (sequences, " + one + ") or (" + one + ")");
  }
  for (py::ssize_t i = 0; i < proposals.size(); ++i)
    if (!std::isfinite(proposals.data()[i])) throw std::invalid_argument("proposals: must be finite");
}

constexpr std::string_view gpu_prefix = "gpu.";

/// `method`: its name, behind `gpu_prefix` for a GPU. Throws slalom.gpu.DeviceError if the device fails.
std::unique_ptr<Controller> make_controller(std::string method, const AnyProblem& problem,
                                            const py::kwargs& keywords) {
  const bool on_gpu = method.starts_with(gpu_prefix);
  if (on_gpu) method.erase(0, gpu_prefix.size());
  SolverOptions options = solver_options(method);
  set_from_keywords(options, keywords, method);
  try {
    return std::make_unique<Controller>(problem, options, on_gpu);
  } catch (const std::runtime_error& error) {
    if (!on_gpu) throw;
    PyErr_SetString(py::module_::import("slalom.gpu").attr("DeviceError").ptr(), error.what());
    throw py::error_already_set();
  }
}

/// Returns method, problem and options, from which `from_state` makes a new controller. Throws
/// std::runtime_error if the controller has been used.
py::object state_of(const py::object& self) {
  const auto& controller = self.cast<const Controller&>();
  if (!controller.is_new())
    throw std::runtime_error(
        "controller: has been used, and its state cannot be pickled: pickle it before its first solve, or "
        "copy it with copy.copy");
  const std::string method = std::string(controller.on_gpu() ? gpu_prefix : "") + controller.solver().name();
  return py::make_tuple(method, self.attr("problem"), values_of(list_options(controller.options())));
}
/// Makes a controller from the state of a pickled one, or as a copy of another one.
std::unique_ptr<Controller> from_state(const py::object& state) {
  if (py::isinstance<Controller>(state)) return state.cast<Controller&>().copy();
  const py::tuple parts = state;
  return make_controller(parts[0].cast<std::string>(), parts[1].cast<const AnyProblem&>(),
                         py::kwargs(py::dict(parts[2])));
}
/// Returns a copy of the same class.
py::object copy(const py::object& self) {
  const py::object cls = self.attr("__class__");
  py::object made = cls.attr("__new__")(cls);
  made.attr("__setstate__")(self);
  return made;
}

Plan solve(const py::object& self, const Numbers& state, double elapsed, double deadline,
           const Numbers& proposals) {
  auto& controller = self.cast<Controller&>();
  check_proposals(controller.solver(), proposals);
  const std::vector<float> values(proposals.data(), proposals.data() + proposals.size());
  const auto count = static_cast<int>(proposals.ndim() == 3 ? proposals.shape(0) : proposals.size() > 0);
  controller.solve(self, vector_of(state, controller.problem().states(), "state"),
                   {elapsed, deadline, {values, count}});
  return {self, controller.solves()};
}

/// The inputs for now.
Numbers command(const py::object& self, const Numbers& state) {
  auto& controller = self.cast<Controller&>();
  const AnyProblem& problem = controller.problem();
  controller.solve(self, vector_of(state, problem.states(), "state"),
                   {controller.is_new() ? 0 : problem.evaluator().time_step()});
  return Numbers(problem.inputs(), controller.inputs().data());
}

std::vector<Plan> solve_batch(const std::vector<py::object>& controllers,
                              std::vector<std::vector<double>> states, double elapsed, double deadline,
                              int threads) {
  if (controllers.size() != states.size())
    throw std::invalid_argument("states: has " + std::to_string(states.size()) + " states, must have " +
                                std::to_string(controllers.size()) + ", one for each controller");
  Controller::solve({controllers.begin(), controllers.end()}, std::move(states), {elapsed, deadline, {}},
                    threads);
  std::vector<Plan> plans;
  for (const py::object& each : controllers) plans.push_back({each, each.cast<Controller&>().solves()});
  return plans;
}

void bind_controller(py::module_& module) {
  py::class_<Controller> base(module, "Controller", "Base class of all controllers.",
                              collected<Controller>());
  base.def(py::init(&make_controller), "method"_a, "problem"_a)
      .def("solve", &solve, "state"_a, "elapsed"_a = 0.0,
           "deadline"_a = std::numeric_limits<double>::infinity(), "proposals"_a = Numbers(),
           "Plans from a state.")
      .def("command", &command, "state"_a,
           "The inputs for now: those of a plan a step of the problem after the last one.")
      .def(py::pickle(&state_of, &from_state))
      .def("__copy__", &copy)
      .def("__deepcopy__", [](const py::object& self, const py::dict&) { return copy(self); })
      .def(
          "reset",
          [](Controller& self, std::optional<std::uint64_t> seed) {
            self.reset(seed ? *seed : values_of(list_options(self.options()))["seed"].cast<std::uint64_t>());
          },
          "seed"_a = py::none(), "Discards all state and starts the random numbers again.")
      .def("set_previous_input", &Controller::set_previous_input, "input"_a,
           "Sets the input applied before the next solve, for problems with limits on their input rates. By "
           "default it is the input that the last plan had for that time.")
      .def("prepare", &Controller::prepare,
           "Draws the noise of the next solve in advance, outside its deadline.")
      .def("_gpu_fault", &Controller::gpu_fault)
      .def("_refresh_gpu", &Controller::refresh_gpu)
      .def_property_readonly(
          "problem", &Controller::problem, py::return_value_policy::reference_internal,
          "the controller's copy of its problem; its parameters may change between solves");
  const auto read = reader(base);
  read("method", "the name of the method",
       [](const Controller& c) { return std::string(c.solver().name()); });
  read("horizon", "steps", [](const Controller& c) { return c.solver().horizon(); });
  read("options", "the options in use, by name", [](const Controller& c) -> py::dict {
    return py::module_::import("slalom.display").attr("Options")(values_of(list_options(c.options())));
  });
}

}  // namespace

void bind_controllers(py::module_& module) {
  bind_plan(module);
  bind_controller(module);
  module.def(
      "solve_batch", &solve_batch, "controllers"_a, "states"_a, "elapsed"_a = 0.0,
      "deadline"_a = std::numeric_limits<double>::infinity(), "threads"_a = 1,
      "The plans of many controllers, in parallel. Copies of one controller draw the same noise unless "
      "each is reset with a seed of its own.");
  module.def(
      "methods",
      [] {
        const auto all = solver_names();
        return std::vector<std::string>(all.begin(), all.end());
      },
      "The names of all methods.");
  module.def("_options_text",
             [](const std::string& method) { return options_text(list_options(solver_options(method))); });
  module.def(
      "options",
      [](const std::string& method) { return describe_options(list_options(solver_options(method))); },
      "method"_a, "The options of a method.");
}

}  // namespace slalom::python
