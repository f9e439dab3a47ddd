#include <dlfcn.h>

#include "controller.hpp"
#include "slalom/core/dispatch.hpp"
#include "slalom/core/network/mlp.hpp"
#include "slalom/maps/field.hpp"
#include "slalom/maps/ros_map.hpp"

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

/// The parameters of a network, from a slalom.mlp.Mlp.
MlpParameters parameters_of(const py::object& network, const std::string& name) {
  if (!py::hasattr(network, "layers") || !py::hasattr(network, "activation"))
    throw py::type_error(name + ": " + py::repr(network).cast<std::string>() +
                         " must be a slalom.mlp.Mlp or the file of one");
  const auto values = [](const py::object& array) {
    const Numbers numbers(array);
    return std::vector<double>(numbers.data(), numbers.data() + numbers.size());
  };
  MlpParameters p;
  for (const py::handle& layer : network.attr("layers")) {
    const auto [weights, biases] = layer.cast<std::pair<Numbers, Numbers>>();
    p.layers.push_back({static_cast<int>(weights.shape(1)), static_cast<int>(weights.shape(0)),
                        values(weights), values(biases)});
  }
  p.activation = activation_of(network.attr("activation").cast<std::string>());
  p.input_mean = values(network.attr("input_mean"));
  p.input_scale = values(network.attr("input_scale"));
  p.output_mean = values(network.attr("output_mean"));
  p.output_scale = values(network.attr("output_scale"));
  p.residual = network.attr("residual").cast<bool>();
  return p;
}

/// Sets numbers, a network (an Mlp or the file of one) or a field (a Field, or the map of which it is the
/// signed distance).
void set_attribute(CompiledProblem& problem, const std::string& name, const py::object& value) {
  const Parameter parameter = parameter_of(problem, name);
  if (parameter.kind == Parameter::Kind::numbers) {
    const auto values = value_as<Numbers>(value, name);
    checked({values.data(), values.data() + values.size()}, parameter.values.size(), name);
    std::copy_n(values.data(), values.size(), parameter.values.begin());
    return;
  }
  const bool is_file = py::hasattr(value, "__fspath__") || py::isinstance<py::str>(value);
  const auto file = is_file ? py::str(value).cast<std::string>() : "";
  if (parameter.kind == Parameter::Kind::network) {
    const MlpParameters network = is_file ? load_mlp(file) : parameters_of(value, name);
    parameter.set(&network);
  } else {
    const maps::Field field =
        is_file ? maps::signed_distance(maps::load_ros_map(file)) : value_as<maps::Field>(value, name);
    parameter.set(&field);
  }
  problem.given[name] = value;
}

/// The value of a parameter for Python: numbers, or what a network or a field was set to.
py::object attribute(CompiledProblem& problem, const Parameter& parameter) {
  if (parameter.kind == Parameter::Kind::numbers) return from_numbers(parameter.values);
  const auto found = problem.given.find(parameter.name);
  return found == problem.given.end() ? py::none() : std::any_cast<py::object>(found->second);
}

/// Loads the library of a compiled problem, which stays loaded. Throws ImportError if that fails.
std::unique_ptr<CompiledProblem> load(const std::string& file, const py::kwargs& keywords) {
  void* const loaded = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const make = loaded ? dlsym(loaded, "slalom_make_problem") : nullptr;
  if (!make) throw py::import_error(dlerror());
  std::unique_ptr<CompiledProblem> problem(reinterpret_cast<CompiledProblem* (*)()>(make)());
  problem->file = file;
  problem->object_of = [](std::any& object) -> void* { return std::any_cast<py::object>(&object); };
  for (const auto& [key, value] : keywords)
    set_attribute(*problem, key.cast<std::string>(), py::reinterpret_borrow<py::object>(value));
  return problem;
}

}  // namespace

void bind_compiled(py::module_& module) {
  py::class_<CompiledProblem, AnyProblem>(
      module, "CompiledProblem",
      "A problem struct that `slalom.compile` has compiled. Its parameters are attributes.",
      collected<CompiledProblem>())
      .def(py::init(&load), "file"_a)
      .def_readonly("file", &CompiledProblem::file, "the file that it was loaded from")
      .def_property_readonly(
          "parameters",
          [](CompiledProblem& self) {
            py::dict all;
            for (const Parameter& parameter : self.parameters())
              all[parameter.name] = attribute(self, parameter);
            return all;
          },
          "the parameters by name")
      .def("__getattr__", [](CompiledProblem& self,
                             const std::string& name) { return attribute(self, parameter_of(self, name)); })
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

  module.def(
      "instruction_set", [] { return std::string(simd::name(simd::active_target())); },
      "The instruction set in use: avx512, avx2, sse4 or generic.");
}

}  // namespace slalom::python
