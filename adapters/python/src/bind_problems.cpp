#include "callable_problem.hpp"
#include "controller.hpp"
#include "rollouts/built_in_problems.hpp"
#include "slalom/core/network/mlp.hpp"

namespace slalom::python {

namespace {

/// The options of a built-in problem.
struct Access {
  Entries (*list)(const AnyProblem&);
  bool (*set)(AnyProblem&, const std::string&, const std::string&);
};

/// Adds the options as attributes: once for all problems, since pybind11 takes long to compile.
void bind_attributes(py::class_<AnyProblem> bound, const Access& access, const Entries& entries,
                     const char* name) {
  for (const OptionEntry& entry : entries) {
    const std::string key = entry.declaration.name;
    bound.def_property(
        key.c_str(),
        [=](const AnyProblem& self) { return py::object(values_of(access.list(self))[key.c_str()]); },
        [=](AnyProblem& self, const py::object& value) {
          set_from_keywords(
              [&](const auto& option, const auto& text) { return access.set(self, option, text); },
              access.list(self), py::kwargs(py::dict(py::arg(key.c_str()) = value)), name);
        },
        entry.declaration.help);
  }
}

template <class P>
py::class_<BuiltIn<P>, AnyProblem> bind_problem(py::module_& module, const char* name,
                                                const std::string& words) {
  using Bound = BuiltIn<P>;
  const Entries entries = list_options(P{});
  const std::string text = words + " The parameters are also attributes." + options_text(entries);
  py::class_<Bound, AnyProblem> bound(module, name, text.c_str());
  bound.def(py::init([name](const py::kwargs& keywords) {
    P problem;
    set_from_keywords(problem, keywords, name);
    return std::make_unique<Bound>(problem);
  }));
  bind_attributes(py::reinterpret_borrow<py::class_<AnyProblem>>(bound),
                  {[](const AnyProblem& p) { return list_options(dynamic_cast<const Bound&>(p).problem()); },
                   [](AnyProblem& p, const std::string& option, const std::string& value) {
                     return set_option(dynamic_cast<Bound&>(p).problem(), option, value);
                   }},
                  entries, name);
  if constexpr (requires(P & p) { p.discs[0].radius; }) {
    bound.def_property(
        "discs", [](const Bound& self) { return discs_of(self.problem().discs); },
        [](Bound& self, const std::vector<std::array<double, 3>>& values) {
          auto& discs = self.problem().discs;
          if (values.size() != discs.size())
            throw std::invalid_argument("discs: must be " + std::to_string(discs.size()) +
                                        " of (x, y, radius)");
          for (std::size_t i = 0; i < discs.size(); ++i)
            discs[i] = {values[i][0], values[i][1], values[i][2]};
        },
        "(x, y, radius) of each disc, m");
  }
  return bound;
}

/// The arguments of slalom.mlp.Mlp; the activation as a number.
py::dict read_mlp(const std::string& file) {
  const MlpParameters p = load_mlp(file);
  py::list layers;
  for (const auto& [inputs, outputs, weights, biases] : p.layers)
    layers.append(py::make_tuple(py::array_t<double>({outputs, inputs}, weights.data()),
                                 py::array_t<double>(outputs, biases.data())));
  const auto given = [](const std::vector<double>& v) { return v.empty() ? py::none() : py::cast(v); };
  return py::dict("layers"_a = layers, "activation"_a = static_cast<int>(p.activation),
                  "input_mean"_a = given(p.input_mean), "input_scale"_a = given(p.input_scale),
                  "output_mean"_a = given(p.output_mean), "output_scale"_a = given(p.output_scale),
                  "residual"_a = p.residual);
}

void bind_any_problem(py::module_& module) {
  py::class_<AnyProblem>(module, "AnyProblem", "Base class of all problems.", guarded())
      .def_property_readonly(
          "states", [](const AnyProblem& self) { return self.states(); }, "scalars of a state")
      .def_property_readonly(
          "inputs", [](const AnyProblem& self) { return self.inputs(); }, "inputs a step")
      .def(
          "step",
          [](AnyProblem& self, const Numbers& state, const Numbers& input, int k) {
            return array_of(self.step(vector_of(state, self.states(), "state"),
                                      vector_of(input, self.inputs(), "input"), k));
          },
          "state"_a, "input"_a, "k"_a = 0, "The state after one step, in double.")
      .def("_expand",
           [](const AnyProblem& self, const Numbers& state, const Numbers& input, int k) {
             return self.expand(
                 vector_of(state, self.states(), "state"),
                 input.size() ? vector_of(input, self.inputs(), "inputs") : std::vector<double>(), k);
           })
      .def_property_readonly(
          "time_step", [](const AnyProblem& self) { return self.evaluator().time_step(); },
          "s, duration of a step; 0: unknown")
      .def_property_readonly(
          "bounds",
          [](const AnyProblem& self) {
            const InputBounds bounds = self.stated_bounds();
            return py::make_tuple(array_of(bounds.low), array_of(bounds.high));
          },
          "least and largest inputs that the problem states: a pair of arrays [inputs]")
      .def(
          "predict",
          [](AnyProblem& self, const Numbers& state, const Numbers& inputs) {
            const py::ssize_t width = self.inputs();
            if (inputs.ndim() != 2 || inputs.shape(1) != width)
              throw std::invalid_argument("inputs: have the shape " + shape_text(extents_of(inputs)) +
                                          ", must have (steps, " + std::to_string(width) + ")");
            const Prediction found =
                self.predict(vector_of(state, self.states(), "state"),
                             std::vector<double>(inputs.data(), inputs.data() + inputs.size()));
            return py::make_tuple(
                Numbers({inputs.shape(0) + 1, py::ssize_t{self.states()}}, found.known_states().data()),
                found.cost);
          },
          "state"_a, "inputs"_a, "The states and the cost of a control sequence.")
      .def(
          "collides",
          [](AnyProblem& self, const Numbers& state) {
            return self.predict(vector_of(state, self.states(), "state"), {}).collided;
          },
          "state"_a, "Whether a state collides.");
}

void bind_callable_problem(py::module_& module) {
  py::class_<CallableProblem, AnyProblem> problem(module, "Problem",
                                                  "A problem of your own: callables on batches of K samples.",
                                                  collected<CallableProblem>());
  problem
      .def(py::init([](py::object dynamics, py::object cost, py::object terminal_cost, int states, int inputs,
                       double dt, const Values& input_min, const Values& input_max,
                       const Values& input_rate_max, const Values& input_levels, py::object sampler,
                       py::object rollout) {
             return std::make_unique<CallableProblem>(
                 CallableParts{dynamics, cost, terminal_cost, states, inputs, dt, numbers_of(input_min),
                               numbers_of(input_max), numbers_of(input_rate_max), numbers_of(input_levels),
                               sampler, rollout});
           }),
           "dynamics"_a = py::none(), "cost"_a = py::none(), "terminal_cost"_a = py::none(), py::kw_only(),
           "states"_a, "inputs"_a, "dt"_a = 0.0, "input_min"_a = py::none(), "input_max"_a = py::none(),
           "input_rate_max"_a = py::none(), "input_levels"_a = py::none(), "sampler"_a = py::none(),
           "rollout"_a = py::none())
      .def_property("dt", &CallableProblem::dt, &CallableProblem::set_dt,
                    "s, duration of a step; 0: unknown");
  const auto read = reader(problem);
  using Parts = CallableParts;
  for (const auto& [name, part] : {std::pair{"dynamics", &Parts::dynamics},
                                   {"cost", &Parts::cost},
                                   {"terminal_cost", &Parts::terminal_cost},
                                   {"sampler", &Parts::sampler},
                                   {"rollout", &Parts::rollout}})
    read(name, "the callable, or None", [part = part](const CallableProblem& p) { return p.parts().*part; });
  for (const auto& [name, part] : {std::pair{"input_min", &Parts::input_min},
                                   {"input_max", &Parts::input_max},
                                   {"input_rate_max", &Parts::input_rate_max},
                                   {"input_levels", &Parts::input_levels}})
    read(name, "as given: a number, one for each input, or None",
         [part = part](const CallableProblem& p) { return from_numbers(p.parts().*part); });
}

void bind_built_in_problems(py::module_& module) {
  bind_problem<problems::Arm>(
      module, "Arm",
      "An arm with seven joints that reaches past a ball. State: the joints' angles (rad); inputs: their "
      "rates (rad/s). The problem has bounds on rates and accelerations.")
      .def_property_readonly(
          "start",
          [](const py::object&) {
            return py::array_t<double>(problems::Arm::joints, problems::Arm::start.data());
          },
          "angles from which the ball is in the way, rad");
  bind_problem<problems::Pendulum>(module, "Pendulum",
                                   "A pendulum whose motor is too weak to lift it directly. State: angle "
                                   "from upright (rad), rate (rad/s); input: torque (N m).");
  bind_problem<problems::CartPole>(module, "CartPole",
                                   "A pole on a cart. State: position (m), speed (m/s), angle from upright "
                                   "(rad), rate (rad/s); input: force (N).");
  bind_problem<problems::DifferentialDrive>(module, "DifferentialDrive",
                                            "A robot with two driven wheels among discs. State: x, y (m), "
                                            "yaw (rad); inputs: speed (m/s), yaw rate (rad/s).");
  bind_problem<problems::Quadrotor>(
      module, "Quadrotor",
      "A quadrotor in the vertical plane and a wall with two gaps. State: x, z (m), tilt (rad) and their "
      "rates; inputs: thrust beyond the weight (m/s^2), turning acceleration (rad/s^2).");
  bind_problem<problems::Car>(module, "Car",
                              "A car that steers and accelerates among parked cars. State: x, y (m), yaw "
                              "(rad), speed (m/s); inputs: steering angle (rad), acceleration (m/s^2).");
}

}  // namespace

void bind_problems(py::module_& module) {
  bind_any_problem(module);
  bind_callable_problem(module);
  bind_built_in_problems(module);
  module.def("_read_mlp", &read_mlp);
}

}  // namespace slalom::python
