#pragma once

#include <cmath>
#include <cstddef>

#include "slalom/core/error.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/option_access.hpp"

namespace slalom {

/// The number of steps that a length takes, rounded up. Throws std::invalid_argument, which names `what`, the
/// length, the step and the limit, if that is more than `limit` or not a number.
inline std::size_t count(double length, double step, double limit, const std::string& what) {
  const double steps = std::ceil(length / step);
  if (steps <= limit) return saturate_cast<std::size_t>(steps);
  throw std::invalid_argument(what + ": " + to_text(length) + " m in steps of " + to_text(step) +
                              " m must be at most " + to_text(limit * step) + " m, " + to_text(limit) +
                              " steps");
}

}  // namespace slalom
