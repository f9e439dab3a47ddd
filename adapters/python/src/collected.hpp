#pragma once

#include <pybind11/pybind11.h>

#include "constructed.hpp"

/// Takes part in Python's garbage collection: objects tell which Python objects they hold, so that a class
/// whose methods are the callables of its own controller is freed.
namespace slalom::python {

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
      const auto& patients = py::detail::get_internals().patients;  // what keep_alive keeps
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
