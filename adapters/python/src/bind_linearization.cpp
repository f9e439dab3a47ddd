#include "python_derivatives.hpp"

namespace slalom::python {
namespace {

py::array_t<double> to_array(const std::vector<double>& values, std::vector<py::ssize_t> shape) {
  return py::array_t<double>(std::move(shape), values.data());
}

/// The rows and columns of a matrix [size][size] from `row` and `column` on.
py::array_t<double> block(const std::vector<double>& matrix, py::ssize_t size, py::ssize_t row,
                          py::ssize_t rows, py::ssize_t column, py::ssize_t columns) {
  py::array_t<double> part({rows, columns});
  for (py::ssize_t i = 0; i < rows; ++i)
    for (py::ssize_t j = 0; j < columns; ++j)
      part.mutable_at(i, j) = matrix[static_cast<std::size_t>((row + i) * size + column + j)];
  return part;
}

/// The result of `linearize`: derivatives with their sizes.
struct Expansion {
  Derivatives d;
  py::ssize_t states, inputs;

  py::array_t<double> gradient(py::ssize_t first, py::ssize_t count) const {
    return py::array_t<double>(count, d.gradient.data() + first);
  }
};

/// The same of a terminal cost.
struct Terminal : Expansion {};

Expansion expand(AnyProblem& problem, std::vector<double> state, std::vector<double> input) {
  state = checked(std::move(state), problem.states(), "state");
  input = checked(std::move(input), problem.inputs(), "input");
  return {problem.derivatives(state, input), problem.states(), problem.inputs()};
}

Expansion expand_terminal(AnyProblem& problem, std::vector<double> state) {
  state = checked(std::move(state), problem.states(), "state");
  return {problem.terminal_derivatives(state), problem.states(), 0};
}

}  // namespace

void bind_linearization(py::module_& module) {
  const auto bind = [&](const char* name, auto expansion, const char* words) {
    return py::class_<decltype(expansion)>(module, name, words);
  };
  bind("Linearization", Expansion{},
       "A problem around a state x and inputs u: derivatives of its step and of its stage cost.")
      .def_property_readonly(
          "next", [](const Expansion& e) { return to_array(e.d.next, {e.states}); },
          "float64 [states], the state after the step")
      .def_property_readonly(
          "state_jacobian",
          [](const Expansion& e) {
            return to_array(e.d.state_jacobian, {e.states, e.states});
          },
          "float64 [states, states], A: derivative of next by x")
      .def_property_readonly(
          "input_jacobian",
          [](const Expansion& e) {
            return to_array(e.d.input_jacobian, {e.states, e.inputs});
          },
          "float64 [states, inputs], B: derivative of next by u")
      .def_property_readonly(
          "cost", [](const Expansion& e) { return e.d.cost; }, "the stage cost")
      .def_property_readonly(
          "state_gradient", [](const Expansion& e) { return e.gradient(0, e.states); },
          "float64 [states], derivative of the cost by x")
      .def_property_readonly(
          "input_gradient", [](const Expansion& e) { return e.gradient(e.states, e.inputs); },
          "float64 [inputs], derivative of the cost by u")
      .def_property_readonly(
          "state_hessian",
          [](const Expansion& e) {
            return block(e.d.hessian, e.states + e.inputs, 0, e.states, 0, e.states);
          },
          "float64 [states, states], second derivative of the cost by x")
      .def_property_readonly(
          "input_hessian",
          [](const Expansion& e) {
            return block(e.d.hessian, e.states + e.inputs, e.states, e.inputs, e.states, e.inputs);
          },
          "float64 [inputs, inputs], second derivative of the cost by u")
      .def_property_readonly(
          "cross_hessian",
          [](const Expansion& e) {
            return block(e.d.hessian, e.states + e.inputs, e.states, e.inputs, 0, e.states);
          },
          "float64 [inputs, states], derivative of the cost by u and x")
      .def_property_readonly(
          "kink", [](const Expansion& e) { return e.d.kink; },
          "whether a function has no derivative at x and u");
  bind("TerminalExpansion", Terminal{}, "Derivatives of the terminal cost at a state.")
      .def_property_readonly(
          "cost", [](const Terminal& e) { return e.d.cost; }, "the terminal cost")
      .def_property_readonly(
          "state_gradient", [](const Terminal& e) { return e.gradient(0, e.states); },
          "float64 [states], derivative by x")
      .def_property_readonly(
          "state_hessian",
          [](const Terminal& e) {
            return to_array(e.d.hessian, {e.states, e.states});
          },
          "float64 [states, states], second derivative by x")
      .def_property_readonly(
          "kink", [](const Terminal& e) { return e.d.kink; }, "whether it has no derivative at x");
  module.def("linearize", &expand, py::arg("problem"), py::arg("state"), py::arg("input"),
             "The Linearization of a problem at a state and inputs: exact for built-in problems, by central "
             "differences in float64 for callables.");
  module.def(
      "expand_terminal_cost",
      [](AnyProblem& problem, std::vector<double> state) {
        return Terminal{expand_terminal(problem, std::move(state))};
      },
      py::arg("problem"), py::arg("state"), "The TerminalExpansion of a problem's terminal cost at a state.");
}

}  // namespace slalom::python
