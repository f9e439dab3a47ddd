#include <algorithm>

#include "plan.hpp"
#include "slalom/solvers/ilqr.hpp"

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

std::vector<double> checked(std::vector<double> values, int count, const char* what) {
  if (static_cast<int>(values.size()) != count)
    throw std::invalid_argument(std::string(what) + ": has " + std::to_string(values.size()) +
                                " values, must have " + std::to_string(count));
  return values;
}

/// What `linearize` returns: derivatives with their sizes.
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

/// The derivatives of a problem in Python, for feedback and iterative LQR.
class PythonDerivatives final : public DifferentiableProblem {
 public:
  explicit PythonDerivatives(AnyProblem& problem) : problem_(problem) {}

  void step(int, std::span<const double> x, std::span<const double> u, std::span<double> next) override {
    const std::vector<double> following = problem_.step(x, u);
    std::copy(following.begin(), following.end(), next.begin());
  }
  double cost(std::span<const double> x, std::span<const double> inputs) override {
    return problem_.predict(x, inputs).cost;
  }
  bool expand_step(int, const FeedbackGains::Step& at) override {
    const Derivatives d = problem_.derivatives(at.state, at.inputs);
    std::copy(d.state_jacobian.begin(), d.state_jacobian.end(), at.state_jacobian.begin());
    std::copy(d.input_jacobian.begin(), d.input_jacobian.end(), at.input_jacobian.begin());
    std::copy(d.gradient.begin(), d.gradient.end(), at.gradient.begin());
    std::copy(d.hessian.begin(), d.hessian.end(), at.hessian.begin());
    return d.kink;
  }
  bool expand_end(const FeedbackGains::Terminal& at) override {
    const Derivatives d = problem_.terminal_derivatives(at.state);
    std::copy(d.gradient.begin(), d.gradient.end(), at.gradient.begin());
    std::copy(d.hessian.begin(), d.hessian.end(), at.hessian.begin());
    return d.kink;
  }

 private:
  AnyProblem& problem_;
};

/// Feedback gains along the plans of a controller.
class Feedback {
 public:
  explicit Feedback(Controller& controller)
      : gains_(controller.problem().states(), controller.problem().inputs(), controller.solver().horizon(),
               controller.bounds()) {}

  bool update(const Plan& plan) {
    Controller& c = plan.controller();
    const auto nx = static_cast<std::size_t>(gains_.states()), nu = static_cast<std::size_t>(gains_.inputs());
    if (c.problem().states() != gains_.states() || c.problem().inputs() != gains_.inputs() ||
        c.solver().horizon() != gains_.steps())
      throw std::invalid_argument("plan: is not one of the controller that this feedback was made for");
    const std::span<const double> states = c.prediction().states, inputs = c.inputs();
    for (int k = 0; k < gains_.steps(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      const auto x = states.subspan(at * nx, nx), u = inputs.subspan(at * nu, nu);
      const FeedbackGains::Step to = gains_.step(k);
      std::copy(x.begin(), x.end(), to.state.begin());
      std::copy(u.begin(), u.end(), to.inputs.begin());
    }
    const auto end = states.last(nx);
    std::copy(end.begin(), end.end(), gains_.terminal().state.begin());
    PythonDerivatives derivatives(c.problem());
    kink_ = gains_.expand(derivatives);
    const double step = c.problem().evaluator().time_step();
    return gains_.solve(step > 0 ? step : 1);
  }

  py::array_t<double> input_at(double t, std::vector<double> state) const {
    state = checked(std::move(state), gains_.states(), "state");
    py::array_t<double> u(gains_.inputs());
    gains_.input_at(t, state, {u.mutable_data(), static_cast<std::size_t>(gains_.inputs())});
    return u;
  }

  py::array_t<double> gains() const {
    const py::ssize_t steps = gains_.steps(), nu = gains_.inputs(), nx = gains_.states();
    return py::array_t<double>({steps, nu, nx}, gains_.gains().data());
  }

  bool has_kink() const { return kink_; }

 private:
  FeedbackGains gains_;
  bool kink_ = false;
};

/// Iterative LQR for the problem of a controller.
class Ilqr {
 public:
  using Inputs = py::array_t<double, py::array::c_style | py::array::forcecast>;

  /// `owner` is the Python object of the controller.
  Ilqr(py::object owner, int iterations)
      : owner_(std::move(owner)),
        inputs_(controller().problem().inputs()),
        lqr_(controller().problem().states(), inputs_, controller().solver().horizon(), controller().bounds(),
             {iterations}) {}

  py::array_t<double> improve(std::vector<double> state, double elapsed) {
    AnyProblem& problem = controller().problem();
    state = checked(std::move(state), problem.states(), "state");
    const double step = problem.evaluator().time_step();
    if (step > 0 && elapsed > 0) lqr_.shift(elapsed / step);
    PythonDerivatives derivatives(problem);
    const std::span<const double> inputs = lqr_.improve(derivatives, state);
    return py::array_t<double>({py::ssize_t{lqr_.steps()}, py::ssize_t{inputs_}}, inputs.data());
  }

  void start_from(const Inputs& inputs) {
    if (inputs.ndim() != 2 || inputs.shape(0) > lqr_.steps() || inputs.shape(1) != inputs_)
      throw std::invalid_argument("inputs: must have the shape (steps, " + std::to_string(inputs_) +
                                  ") with at most " + std::to_string(lqr_.steps()) + " steps");
    lqr_.start_from({inputs.data(), static_cast<std::size_t>(inputs.size())});
  }

  const IterativeLqr& result() const { return lqr_; }

 private:
  Controller& controller() const { return owner_.cast<Controller&>(); }

  py::object owner_;
  int inputs_;
  IterativeLqr lqr_;
};

void bind_ilqr(py::module_& module) {
  py::class_<Ilqr>(
      module, "Ilqr",
      "Improves control sequences by iterative LQR, with the derivatives of a controller's problem: for "
      "proposals, or as a controller of smooth problems by itself.\n\n"
      "controller: whose problem, horizon and bounds hold\n"
      "iterations: most steps of an improvement")
      .def(py::init([](const py::object& controller, int iterations) {
             if (!py::isinstance<Controller>(controller))
               throw py::type_error("Ilqr: controller must be a slalom.Controller");
             return std::make_unique<Ilqr>(controller, iterations);
           }),
           py::arg("controller"), py::arg("iterations") = IlqrOptions{}.iterations)
      .def("improve", &Ilqr::improve, py::arg("state"), py::arg("elapsed") = 0.0,
           "The best sequence from `state` that the steps find, float64 [horizon, inputs]. They start from "
           "the "
           "last sequence, moved forward by `elapsed` (s).")
      .def("start_from", &Ilqr::start_from, py::arg("inputs"),
           "Sets the sequence that is improved next, an array (steps, inputs); the last inputs are held. "
           "Without rows, the inputs are those nearest to 0.")
      .def_property_readonly(
          "cost", [](const Ilqr& i) { return i.result().cost(); }, "cost of the sequence")
      .def_property_readonly(
          "first_cost", [](const Ilqr& i) { return i.result().first_cost(); },
          "cost before the last improvement")
      .def_property_readonly(
          "iterations", [](const Ilqr& i) { return i.result().iterations(); },
          "steps of the last improvement")
      .def_property_readonly(
          "has_kink", [](const Ilqr& i) { return i.result().has_kink(); },
          "whether the last improvement met a function without derivative");
}

}  // namespace

void bind_feedback(py::module_& module) {
  bind_linearization(module);
  bind_ilqr(module);
  py::class_<Feedback>(module, "Feedback",
                       "Feedback around the plans of a controller, for the time between two plans: gains of "
                       "a linear-quadratic "
                       "regulator along the plan.\n\ncontroller: whose plans are followed.")
      .def(py::init<Controller&>(), py::arg("controller"))
      .def(
          "update", &Feedback::update, py::arg("plan"),
          "Computes the gains along a plan and keeps it. Returns False, with gains 0, if a derivative is not "
          "finite.")
      .def("input_at", &Feedback::input_at, py::arg("t"), py::arg("state"),
           "The inputs for a state at time `t` (s) after the plan was made, within the bounds: those of the "
           "plan plus gain times deviation.")
      .def_property_readonly("gains", &Feedback::gains, "float64 [horizon, inputs, states]")
      .def_property_readonly("has_kink", &Feedback::has_kink,
                             "whether a function has no derivative somewhere along the plan");
}

}  // namespace slalom::python
