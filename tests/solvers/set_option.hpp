#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "slalom/solvers/solver_options.hpp"

namespace slalom::testing {

/// Sets an option of any method by its name, unchecked; false if the method has no such option.
inline bool set_if_any(SolverOptions& options, std::string_view name, const PerInput& value) {
  bool found = false;
  visit_options(options, [&](auto& field, const Declaration& declaration) {
    using Field = std::remove_cvref_t<decltype(field)>;
    if (name != declaration.name) return;
    found = true;
    if constexpr (std::is_same_v<Field, PerInput>) {
      field = value;
    } else if constexpr (std::is_arithmetic_v<Field>) {
      field = static_cast<Field>(value[0]);
    } else {
      throw std::logic_error(std::string(name) + " is not a number");
    }
  });
  return found;
}

/// The same for an option that the method must have.
inline void set(SolverOptions& options, std::string_view name, const PerInput& value) {
  if (!set_if_any(options, name, value)) throw std::logic_error("unknown option " + std::string(name));
}

}  // namespace slalom::testing
