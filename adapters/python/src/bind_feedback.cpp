#include "plan.hpp"
#include "python_derivatives.hpp"

namespace slalom::python {
namespace {

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

}  // namespace

void bind_feedback(py::module_& module) {
  py::class_<Feedback>(module, "Feedback",
                       "Feedback around the plans of a controller, for the time between two plans: gains of "
                       "a linear-quadratic regulator along the plan.\n\n"
                       "controller: whose plans are followed.")
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
