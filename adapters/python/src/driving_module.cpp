#include "driving.hpp"

PYBIND11_MODULE(_driving, module) {
  module.doc() = "Courses, simulator and planner of cars, and the navigator of mobile robots.";
  pybind11::module_::import("slalom._slalom");  // registers the exceptions
  slalom::python::bind_world(module);
  slalom::python::bind_driving(module);
  slalom::python::bind_navigation(module);
}
