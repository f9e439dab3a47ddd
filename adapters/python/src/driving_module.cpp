#include "driving.hpp"

PYBIND11_MODULE(_driving, module) {
  module.doc() = "Courses, simulator and planner of cars.";
  pybind11::module_::import("slalom._slalom");  // registers the exceptions
  slalom::python::bind_world(module);
  slalom::python::bind_driving(module);
}
