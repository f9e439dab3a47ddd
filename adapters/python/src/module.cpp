#include "controller.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/version.hpp"

namespace {

/// Throws ImportError if this pybind11 does not know the arrays of the installed numpy, whose values it would
/// read wrongly.
void check_numpy() {
  const auto version = pybind11::module_::import("numpy").attr("__version__").cast<std::string>();
  if (PYBIND11_VERSION_HEX < 0x020C0000 && std::stoi(version) >= 2)
    throw pybind11::import_error(
        "slalom was built with a pybind11 before 2.12, which does not know numpy " + version +
        ": install it with `pip install .`, which takes a newer pybind11 from the index, or use numpy 1");
}

}  // namespace

PYBIND11_MODULE(_slalom, module) {
  check_numpy();
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
