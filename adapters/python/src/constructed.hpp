#pragma once

#include <pybind11/pybind11.h>

#include <string>

/// Objects that `cls.__new__(cls)` made, without `__init__`: they have no C++ part, in whose place pybind11
/// would give functions memory without values. Their attributes are errors.
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

}  // namespace slalom::python
