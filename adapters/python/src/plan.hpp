#pragma once

#include "controller.hpp"

namespace slalom::python {

/// The solution of a controller in Python. Its arrays are views of the controller's memory.
struct Plan {
  py::object owner;     ///< the controller
  std::uint64_t solve;  ///< Controller::solves of this plan

  /// Throws std::runtime_error if the controller has solved again.
  Controller& controller() const {
    auto& c = owner.cast<Controller&>();
    if (c.solves() != solve)
      throw std::runtime_error(
          "plan: the controller has solved again; copy what you keep before the next solve");
    return c;
  }
  const SolveResult& result() const { return controller().result(); }
};

void bind_plan(py::module_& module);

}  // namespace slalom::python
