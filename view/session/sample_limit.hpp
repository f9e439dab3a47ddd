#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "slalom/solvers/solver_options.hpp"

namespace slalom::view {

/// Throws std::invalid_argument for options with more samples times steps than a page can wait for: 2^22 take
/// about 0.05 s.
inline void check_samples(const SolverOptions& options) {
  constexpr std::int64_t most = std::int64_t{1} << 22;
  const int* samples = options.find<int>("samples");
  const int* horizon = options.find<int>("horizon");
  if (!samples || !horizon || std::int64_t{*samples} * *horizon <= most) return;
  throw std::invalid_argument("samples: " + std::to_string(*samples) + " must be at most " +
                              std::to_string(most / *horizon) + " in the live view, for " +
                              std::to_string(*horizon) + " steps");
}

}  // namespace slalom::view
