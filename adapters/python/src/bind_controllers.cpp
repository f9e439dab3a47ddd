#include <cctype>
#include <limits>

#include "plan.hpp"

namespace slalom::python {
namespace {

/// The class of a method: svg_mppi -> SvgMppi.
std::string class_name(std::string_view method) {
  std::string name;
  bool upper = true;
  for (const char c : method) {
    if (c == '_') {
      upper = true;
    } else {
      name += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      upper = false;
    }
  }
  return name;
}

template <class Options>
struct Method : Controller {
  Method(const AnyProblem& problem, const Options& options) : Controller(problem, options) {}
};

template <class Options>
void bind_method(py::module_& module) {
  const std::string method = solver_name(SolverOptions(Options{}));
  const std::string text =
      "A controller that solves its problem by the method `" + method +
      "`.\n\nThe problem is copied: `controller.problem` is the copy, whose parameters may "
      "change between solves. Keyword arguments with their defaults:\n\n" +
      options_text(Options{});
  py::class_<Method<Options>, Controller>(module, class_name(method).c_str(), text.c_str())
      .def(py::init([method](const AnyProblem& problem, const py::kwargs& keywords) {
             Options options;
             set_from_keywords(options, keywords, method);
             return std::make_unique<Method<Options>>(problem, options);
           }),
           py::arg("problem"));
}

template <std::size_t... I>
void bind_methods(py::module_& module, std::index_sequence<I...>) {
  (bind_method<std::variant_alternative_t<I, SolverOptions>>(module), ...);
}

}  // namespace

void bind_controllers(py::module_& module) {
  bind_plan(module);
  py::class_<Controller>(module, "Controller", "Base class of all controllers.")
      .def(
          "solve",
          [](const py::object& self, std::vector<double> state, double elapsed, double deadline) {
            auto& controller = self.cast<Controller&>();
            controller.solve(self, std::move(state), {elapsed, deadline});
            return Plan{self, controller.solves()};
          },
          py::arg("state"), py::arg("elapsed") = 0.0,
          py::arg("deadline") = std::numeric_limits<double>::infinity(),
          "Returns the plan from `state`. The warm start is shifted by `elapsed` (s), the time since the "
          "last "
          "solve. After `deadline` (s) the best plan so far is returned.")
      .def("reset", &Controller::reset, py::arg("seed") = 0,
           "Discards all state and starts the random numbers from `seed`.")
      .def("set_previous_input", &Controller::set_previous_input, py::arg("input"),
           "Sets the input applied before the next solve, for problems with limits on their input rates. "
           "By default it is the input that the last plan had for that time.")
      .def("prepare", &Controller::prepare,
           "Draws the noise of the next solve in advance, outside its deadline.")
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
      py::arg("method"), "The options of a method: a dictionary for each.");
}

}  // namespace slalom::python
