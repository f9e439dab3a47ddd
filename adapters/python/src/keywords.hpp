#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "slalom/core/error.hpp"
#include "slalom/core/final_check.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/maps/pose.hpp"

/// The objects of the compiled classes as Python's own machinery sees them. They tell the garbage collection
/// which Python objects they hold, so that a class whose methods are the callables of its own controller is
/// freed. Objects that `cls.__new__(cls)` made, without `__init__`, have no C++ part, in whose place pybind11
/// would give functions memory without values: their attributes are errors.
/// Options as keyword arguments: names, defaults, ranges and errors are those of the C++ declarations.
namespace slalom::python {

namespace py = pybind11;

inline bool is_constructed(PyObject* self) {
  const auto* const instance = reinterpret_cast<py::detail::instance*>(self);
  return !instance->simple_layout || instance->simple_value_holder[0];
}

/// Whether an attribute may be used. Sets TypeError if not: it is one of a class of slalom, which needs the
/// C++ part. Those of a user's class may be used before its `__init__` calls that of slalom.
inline bool may_use(PyObject* self, PyObject* name) {
  if (is_constructed(self)) return true;
  const std::string key = py::str(py::handle(name));
  if (key == "__setstate__" || key == "__init__") return true;
  for (const py::handle& each : py::reinterpret_borrow<py::tuple>(Py_TYPE(self)->tp_mro)) {
    const auto* const type = reinterpret_cast<PyTypeObject*>(each.ptr());
    if (!PyDict_Contains(type->tp_dict, name)) continue;
    const auto module = py::str(each.attr("__module__")).cast<std::string>();
    if (!module.starts_with("slalom._") && module != "pybind11_builtins") return true;
    PyErr_SetString(PyExc_TypeError, (std::string(Py_TYPE(self)->tp_name) + "." + key +
                                      ": __init__ of the object has not been called")
                                         .c_str());
    return false;
  }
  return true;
}

/// Guards the attributes of a class and of those derived from it.
inline void guard_attributes(PyTypeObject& type) {
  type.tp_getattro = [](PyObject* self, PyObject* name) {
    return may_use(self, name) ? PyObject_GenericGetAttr(self, name) : nullptr;
  };
  type.tp_setattro = [](PyObject* self, PyObject* name, PyObject* value) {
    return may_use(self, name) ? PyObject_GenericSetAttr(self, name, value) : -1;
  };
}
/// An attribute of a class_ that guards its attributes.
inline py::custom_type_setup guarded() {
  return py::custom_type_setup([](PyHeapTypeObject* heap) { guard_attributes(heap->ht_type); });
}

/// The object of class `T` that a Python object owns, or null: before `__init__`, if it only refers to one.
template <class T>
T* owned_by(PyObject* self) {
  const auto* const instance = reinterpret_cast<py::detail::instance*>(self);
  if (!instance->simple_layout || !instance->owned || !instance->simple_holder_constructed) return nullptr;
  return static_cast<T*>(instance->simple_value_holder[0]);
}

/// An attribute of a class_ for `T`, whose `each_object(f)` calls f with a pointer to each py::object in it.
template <class T>
py::custom_type_setup collected() {
  return py::custom_type_setup([](PyHeapTypeObject* heap) {
    PyTypeObject& type = heap->ht_type;
    guard_attributes(type);
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) -> int {
      Py_VISIT(Py_TYPE(self));
      int result = 0;
      const auto look = [&](PyObject* object) {
        if (object && result == 0) result = visit(object, arg);
      };
      if (T* const value = owned_by<T>(self))
        value->each_object([&](void* object) { look(static_cast<py::object*>(object)->ptr()); });
      const auto& patients = py::detail::get_internals().patients;  // objects that keep_alive keeps
      if (const auto found = patients.find(self); found != patients.end())
        for (PyObject* const patient : found->second) look(patient);
      return result;
    };
    type.tp_clear = [](PyObject* self) -> int {
      if (T* const value = owned_by<T>(self))
        value->each_object([](void* object) { *static_cast<py::object*>(object) = py::none(); });
      return 0;
    };
    type.tp_dealloc = [](PyObject* self) {
      PyObject_GC_UnTrack(self);
      py::detail::pybind11_object_dealloc(self);
    };
  });
}

using namespace pybind11::literals;

/// An array of doubles, row by row. Made of an object it is converted as numpy does, or throws.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Throws what a signal handler raised, such as KeyboardInterrupt; for long loops without the lock.
inline void check_signals() {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// An array [number] with a copy of the values.
inline Numbers array_of(std::span<const double> values) {
  return Numbers(static_cast<py::ssize_t>(values.size()), values.data());
}

/// Returns a function that adds a property which cannot be set: name, help, getter.
template <class Class>
auto reader(Class& bound) {
  return [&bound](const char* name, const char* help, auto get) {
    bound.def_property_readonly(name, get, help);
  };
}

/// A shape as Python writes it: (), (3,), (3, 2).
inline std::string shape_text(std::span<const py::ssize_t> shape) {
  std::string text = "(";
  for (const py::ssize_t size : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(size);
  return text + (shape.size() == 1 ? ",)" : ")");
}
inline std::span<const py::ssize_t> extents_of(const py::array& array) {
  return {array.shape(), static_cast<std::size_t>(array.ndim())};
}

/// Poses are tuples in Python.
inline py::tuple to_tuple(const maps::Pose& pose) {
  return py::make_tuple(pose.x, pose.y, pose.yaw);
}

/// Discs as a list of tuples.
template <class Discs>
py::list discs_of(const Discs& discs) {
  py::list all;
  for (const auto& disc : discs) all.append(py::make_tuple(disc.x, disc.y, disc.radius));
  return all;
}

/// Marks an array as one that must not be written.
inline py::array read_only(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// A view of an array that must not be written, for a function of Python; the array itself does not change.
inline py::array lent(const py::array& array) {
  return read_only(py::array(array.dtype(), {array.shape(), array.shape() + array.ndim()},
                             {array.strides(), array.strides() + array.ndim()}, array.data(), array));
}

/// The value of a parameter as a T. Throws TypeError with its name if it cannot be one.
template <class T>
T value_as(const py::handle& value, const std::string& name) {
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    throw py::type_error(name + ": " + std::string(py::repr(py::type::handle_of(value))) +
                         " has the wrong form");
  }
}

/// Throws std::invalid_argument unless there are as many values as `count`. Returns them.
inline const std::vector<double>& checked(const std::vector<double>& values, std::size_t count,
                                          const std::string& what) {
  if (values.size() != count)
    throw std::invalid_argument(what + ": has " + std::to_string(values.size()) + " values, must have " +
                                std::to_string(count));
  return values;
}

/// The values of a state or of an input. Throws std::invalid_argument unless the array is [count].
inline std::vector<double> vector_of(const Numbers& values, int count, const std::string& what) {
  if (values.ndim() != 1)
    throw std::invalid_argument(what + ": has the shape " + shape_text(extents_of(values)) + ", must be (" +
                                std::to_string(count) + ",)");
  return checked({values.data(), values.data() + values.size()}, static_cast<std::size_t>(count), what);
}

/// How many values may be given for each of `count`: one for all, or one each.
inline std::string one_or(int count) {
  return count == 1 ? "1" : "1 or " + std::to_string(count);
}

/// Values that are given as one number, as a sequence, or not at all: None.
using Values = std::variant<std::monostate, double, std::vector<double>>;
inline std::vector<double> numbers_of(const Values& values) {
  if (const double* one = std::get_if<double>(&values)) return {*one};
  if (const auto* all = std::get_if<std::vector<double>>(&values)) return *all;
  return {};
}
/// The same values for Python.
inline py::object from_numbers(std::span<const double> values) {
  if (values.empty()) return py::none();
  if (values.size() == 1) return py::float_(values[0]);
  return py::cast(std::vector<double>(values.begin(), values.end()));
}
/// The value for one of the inputs: the only value is that of each, and without values it is `otherwise`.
inline double value_for(const std::vector<double>& values, int input, double otherwise) {
  if (values.empty()) return otherwise;
  return values.size() == 1 ? values[0] : values[static_cast<std::size_t>(input)];
}
/// The bounds of inputs by their values. Throws std::invalid_argument if one is nan.
inline InputBounds bounds_of(const std::vector<double>& least, const std::vector<double>& most, int inputs) {
  InputBounds bounds(inputs);
  for (int i = 0; i < inputs; ++i) {
    double &low = bounds.low[static_cast<std::size_t>(i)], &high = bounds.high[static_cast<std::size_t>(i)];
    low = value_for(least, i, low);
    high = value_for(most, i, high);
    if (std::isnan(low) || std::isnan(high))
      throw std::invalid_argument("Problem.input_min, Problem.input_max: nan must be a number");
  }
  return bounds;
}

/// An option's value as a configuration file has it.
inline std::string text_of(const py::handle& value) {
  PyObject* const object = value.ptr();
  if (py::isinstance<py::bool_>(value)) return to_text(value.cast<bool>());
  if (PyNumber_Check(object) && !PyIndex_Check(object))  // with a point: 2.0 is no number of steps
    return py::str(py::float_(value_as<double>(value, "an option")));
  if (py::isinstance<py::str>(value) || !py::isinstance<py::sequence>(value))
    return value_as<std::string>(py::str(value), "an option");
  std::string text;
  for (const py::handle& each : value) text.append(text.empty() ? "[" : ", ").append(text_of(each));
  return text.empty() ? "[]" : text + "]";
}

using Entries = std::vector<OptionEntry>;

/// Sets options by `set(name, text)`, which returns false if there is none of that name. Throws ValueError
/// with `where`, the name, the value and its rule, or TypeError if there is no option of a name.
inline void set_from_keywords(const std::function<bool(const std::string&, const std::string&)>& set,
                              const Entries& entries, const py::kwargs& keywords, const std::string& where) {
  for (const auto& [key, value] : keywords) {
    const auto name = value_as<std::string>(key, where + ": the name of an option");
    try {
      if (set(name, text_of(value))) continue;
    } catch (const std::invalid_argument& error) {
      throw py::value_error(where + "." + name + ": " + error.what());
    }
    std::vector<std::string> names;
    for (const OptionEntry& entry : entries) names.emplace_back(entry.declaration.name);
    const std::string nearest = nearest_name(name, names);
    throw py::type_error(shortened(where + ": unknown option '" + name + "'" +
                                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?")));
  }
}
template <class Options>
void set_from_keywords(Options& options, const py::kwargs& keywords, const std::string& where) {
  set_from_keywords([&](const auto& name, const auto& text) { return set_option(options, name, text); },
                    list_options(options), keywords, where);
}

inline py::object to_python(const OptionValue& value) {
  return std::visit(
      [](const auto& v) -> py::object {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::vector<double>>) {
          if (v.size() == 1) return py::cast(v[0]);
        }
        return py::cast(v);
      },
      value);
}

/// The options as a list of dictionaries.
inline py::list describe_options(const Entries& entries) {
  py::list all;
  for (const OptionEntry& entry : entries) {
    const Declaration& d = entry.declaration;
    all.append(py::dict("name"_a = d.name, "type"_a = type_name(entry), "default"_a = to_python(entry.value),
                        "symbol"_a = d.symbol, "unit"_a = d.unit, "min"_a = d.min, "max"_a = d.max,
                        "choices"_a = entry.choices, "help"_a = d.help));
  }
  return all;
}

/// The values of the options by name.
inline py::dict values_of(const Entries& entries) {
  py::dict all;
  for (const OptionEntry& entry : entries) all[entry.declaration.name] = to_python(entry.value);
  return all;
}

/// The options as a docstring lists parameters.
inline std::string options_text(const Entries& entries) {
  std::string text = "\n\nParameters\n----------\n";
  for (const OptionEntry& entry : entries) {
    const Declaration& d = entry.declaration;
    const std::string kind = type_name(entry);
    text += std::string(d.name) + " : " +
            (kind == "flag"      ? "bool"
             : kind == "integer" ? "int"
             : kind == "choice"  ? "str"
                                 : "float") +
            (kind == "numbers" ? " or (inputs,)" : "") + (*d.unit ? ", " + std::string(d.unit) : "") +
            ", default " + py::repr(to_python(entry.value)).cast<std::string>() + "\n    " + d.help;
    for (std::size_t i = 0; i < entry.choices.size(); ++i)
      text += (i ? ", " : "; one of ") + entry.choices[i];
    text += "\n";
  }
  return text;
}

}  // namespace slalom::python
