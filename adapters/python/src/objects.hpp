#pragma once

#include <pybind11/pybind11.h>

#include <string>

/// The objects of the compiled classes as Python's own machinery sees them. They tell the garbage collection
/// which Python objects they hold, so that a class whose methods are the callables of its own controller is
/// freed. Objects that `cls.__new__(cls)` made, without `__init__`, have no C++ part, in whose place pybind11
/// would give functions memory without values: their attributes are errors.
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

/// The object of class `T` that a Python object owns, or null: before `__init__`, or if it only refers to
/// one.
template <class T>
T* owned_by(PyObject* self) {
  const auto* const instance = reinterpret_cast<py::detail::instance*>(self);
  if (!instance->simple_layout || !instance->owned || !instance->simple_holder_constructed) return nullptr;
  return static_cast<T*>(instance->simple_value_holder[0]);
}

/// An attribute of a class_ for `T`, whose `each_object(f)` calls f with a pointer to each py::object it
/// holds.
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

}  // namespace slalom::python
