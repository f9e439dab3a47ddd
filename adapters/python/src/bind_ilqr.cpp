#include "python_derivatives.hpp"

namespace slalom::python {
namespace {

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

}  // namespace

void bind_ilqr(py::module_& module) {
  py::class_<Ilqr>(
      module, "Ilqr",
      "Improves control sequences by iterative LQR, with the derivatives of a controller's problem: for "
      "proposals, or as a controller of smooth problems by itself.\n\n"
      "controller: its problem, horizon and bounds are used\n"
      "iterations: maximum number of steps of an improvement")
      .def(py::init([](const py::object& controller, int iterations) {
             if (!py::isinstance<Controller>(controller))
               throw py::type_error("Ilqr: controller must be a slalom.Controller");
             return std::make_unique<Ilqr>(controller, iterations);
           }),
           py::arg("controller"), py::arg("iterations") = IlqrOptions{}.iterations)
      .def("improve", &Ilqr::improve, py::arg("state"), py::arg("elapsed") = 0.0,
           "The best sequence from `state` that the steps find, float64 [horizon, inputs]. They start from "
           "the last sequence, moved forward by `elapsed` (s).")
      .def("start_from", &Ilqr::start_from, py::arg("inputs"),
           "Sets the sequence that is improved next, an array (steps, inputs); the last inputs are held. "
           "Without rows, the inputs are those nearest to 0.")
      .def_property_readonly(
          "cost", [](const Ilqr& i) { return i.result().cost(); },
          "cost of the sequence that the last improvement returned")
      .def_property_readonly(
          "first_cost", [](const Ilqr& i) { return i.result().first_cost(); },
          "cost before the last improvement")
      .def_property_readonly(
          "iterations", [](const Ilqr& i) { return i.result().iterations(); },
          "steps of the last improvement")
      .def_property_readonly(
          "has_kink", [](const Ilqr& i) { return i.result().has_kink(); },
          "whether a function had no derivative at a point of the last improvement");
}

}  // namespace slalom::python
