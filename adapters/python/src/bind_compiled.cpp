#include <dlfcn.h>

#include <functional>

#include "controller.hpp"
#include "network_problem.hpp"
#include "slalom/core/dispatch.hpp"

namespace slalom::python {
namespace {

/// The parameter of a name. Throws AttributeError, with the names of all, if there is none.
Parameter parameter_of(CompiledProblem& problem, const std::string& name) {
  std::string names;
  for (const Parameter& each : problem.parameters()) {
    if (name == each.name) return each;
    names += (names.empty() ? "" : ", ") + std::string(each.name);
  }
  throw py::attribute_error("the problem has no parameter '" + name +
                            "'; it has: " + (names.empty() ? "none" : names));
}

void set_attribute(CompiledProblem& problem, const std::string& name, const py::object& value) {
  const Parameter parameter = parameter_of(problem, name);
  const std::vector<double> values = numbers_of(value_as<Values>(value, name));
  checked(values, parameter.values.size(), name);
  std::copy(values.begin(), values.end(), parameter.values.begin());
}

/// Loads the library of a compiled problem, which stays loaded. Throws ImportError if that fails.
std::unique_ptr<CompiledProblem> load(const std::string& file, const py::kwargs& keywords) {
  void* const loaded = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const make = loaded ? dlsym(loaded, "slalom_make_problem") : nullptr;
  if (!make) throw py::import_error(dlerror());
  std::unique_ptr<CompiledProblem> problem(reinterpret_cast<CompiledProblem* (*)()>(make)());
  problem->file = file;
  for (const auto& [key, value] : keywords)
    set_attribute(*problem, key.cast<std::string>(), py::reinterpret_borrow<py::object>(value));
  return problem;
}

/// Parts of a network's problem from keyword arguments.
using Parts = NetworkProblem::Parts;

/// A part of a network's problem: how Python sets it, and what Python reads.
struct Part {
  const char* name;
  const char* help;
  std::function<void(Parts&, const py::object&)> set;
  std::function<py::object(const Parts&)> get;
};

Part number(const char* name, const char* help, double NetworkModel::*part) {
  const std::string label = std::string("MlpProblem.") + name;
  return {name, help,
          [=](Parts& p, const py::object& value) { p.model.*part = value_as<double>(value, label); },
          [=](const Parts& p) { return py::object(py::float_(p.model.*part)); }};
}

Part field(const char* name, const char* help, py::object Parts::*part) {
  const std::string label = std::string("MlpProblem.") + name;
  const auto set = [=](Parts& p, const py::object& value) {
    if (!value.is_none()) value_as<maps::Field>(value, label);
    p.*part = value;
  };
  return {name, help, set, [=](const Parts& p) { return p.*part; }};
}

Part numbers(const char* name, const char* help, std::vector<double> NetworkModel::*part) {
  const std::string label = std::string("MlpProblem.") + name;
  return {
      name, help,
      [=](Parts& p, const py::object& value) { p.model.*part = numbers_of(value_as<Values>(value, label)); },
      [=](const Parts& p) { return from_numbers(p.model.*part); }};
}

const Part network_parts[] = {
    numbers("goal", "the state that costs nothing; default: 0", &NetworkModel::goal),
    numbers("state_weights", "costs of the squared distances from the goal, in each step",
            &NetworkModel::state_weights),
    numbers("terminal_weights", "the same, after the last step", &NetworkModel::terminal_weights),
    numbers("input_weights", "costs of the squared inputs", &NetworkModel::input_weights),
    {"discs", "(x, y, radius) of discs in the plane of the first two states; a state within one collides",
     [](Parts& p, const py::object& value) {
       p.model.discs.clear();
       if (value.is_none()) return;
       for (const auto& [x, y, radius] :
            value_as<std::vector<std::tuple<double, double, double>>>(value, "MlpProblem.discs"))
         p.model.discs.push_back({x, y, radius});
     },
     [](const Parts& p) { return py::object(discs_of(p.model.discs)); }},
    number("disc_weight", "cost of a state that collides, with a disc or a wall", &NetworkModel::disc_weight),
    field("walls", "Field with the distance from the nearest wall (slalom.signed_distance), m, or None",
          &Parts::walls),
    number("clearance", "m: a state collides where `walls` is less", &NetworkModel::clearance),
    field("field", "Field that is a part of the cost of a state, or None", &Parts::field),
    number("field_weight", "factor of `field`", &NetworkModel::field_weight),
    number("dt", "s, duration of a step; 0: unknown", &NetworkModel::dt),
    numbers("input_min", "least inputs: a number, one for each input, or None", &NetworkModel::input_min),
    numbers("input_max", "largest inputs: a number, one for each input, or None", &NetworkModel::input_max),
};

/// Sets the parts that are given. Throws TypeError if there is no part of a name.
Parts with_keywords(Parts parts, const py::kwargs& keywords) {
  for (const auto& [key, value] : keywords) {
    const auto name = key.cast<std::string>();
    const auto* const part = std::find_if(std::begin(network_parts), std::end(network_parts),
                                          [&](const Part& each) { return name == each.name; });
    if (part == std::end(network_parts)) throw py::type_error("MlpProblem: unknown argument '" + name + "'");
    part->set(parts, py::reinterpret_borrow<py::object>(value));
  }
  return parts;
}

}  // namespace

void bind_compiled(py::module_& module) {
  py::class_<CompiledProblem, AnyProblem>(
      module, "CompiledProblem",
      "A problem struct that `slalom.compile` has compiled. Its parameters are attributes.")
      .def(py::init(&load), "file"_a)
      .def_readonly("file", &CompiledProblem::file, "the file that it was loaded from")
      .def_property_readonly(
          "parameters",
          [](CompiledProblem& self) {
            py::dict all;
            for (const Parameter& parameter : self.parameters())
              all[parameter.name] = from_numbers(parameter.values);
            return all;
          },
          "the parameters by name")
      .def("__getattr__",
           [](CompiledProblem& self, const std::string& name) {
             return from_numbers(parameter_of(self, name).values);
           })
      .def("__setattr__",
           [](const py::object& self, const std::string& name, const py::object& value) {
             if (may_use(self.ptr(), py::str("parameters").ptr()))
               return set_attribute(self.cast<CompiledProblem&>(), name, value);
             throw py::error_already_set();
           })
      .def("__dir__", [](CompiledProblem& self) {
        py::list all = py::module_::import("builtins").attr("object").attr("__dir__")(py::cast(self));
        for (const Parameter& parameter : self.parameters()) all.append(parameter.name);
        return all;
      });

  std::string words =
      "A problem whose dynamics is a network, at the speed of C++.\n\n"
      "network: a slalom.mlp.Mlp that maps a state and the inputs of a step to the next state (with "
      "`residual`: to its change), together at most 64 values\n\n"
      "The cost of a state is sum of weight * (state - goal)^2, and that of inputs sum of weight * input^2. "
      "A weight or bound is one number, or one for each state or input. Keyword arguments, also "
      "attributes:\n\n";
  for (const Part& part : network_parts) words += "    " + std::string(part.name) + ": " + part.help + "\n";
  py::class_<NetworkProblem, AnyProblem> problem(module, "MlpProblem", words.c_str(),
                                                 collected<NetworkProblem>());
  problem.def(py::init([](const py::object& network, const py::kwargs& keywords) {
                return std::make_unique<NetworkProblem>(with_keywords({network, {}}, keywords));
              }),
              "network"_a);
  reader(problem)("network", "the network", [](const NetworkProblem& p) { return p.parts().network; });
  for (const Part& part : network_parts)
    problem.def_property(
        part.name, [&part](const NetworkProblem& p) { return part.get(p.parts()); },
        [&part](NetworkProblem& p, const py::object& value) {
          Parts parts = p.parts();
          part.set(parts, value);
          p.set_parts(std::move(parts));
        },
        part.help);
  module.def(
      "instruction_set", [] { return std::string(simd::name(simd::active_target())); },
      "The instruction set in use: avx512, avx2, sse4 or generic.");
}

}  // namespace slalom::python
