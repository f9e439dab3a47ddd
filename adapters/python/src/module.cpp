#include "controller.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/version.hpp"

PYBIND11_MODULE(_slalom, module) {
  module.doc() = "Real-time sampling-based stochastic optimal control.";
  pybind11::register_exception<slalom::IoError>(module, "IoError", PyExc_OSError);
  slalom::python::bind_problems(module);
  slalom::python::bind_compiled(module);
  slalom::python::bind_risk(module);
  slalom::python::bind_controllers(module);
  slalom::python::bind_maps(module);
#ifdef SLALOM_HAS_VIEW
  slalom::python::bind_view(module);
#endif
  module.attr("__version__") = slalom::version();
}
