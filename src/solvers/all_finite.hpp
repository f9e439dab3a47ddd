#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace slalom::detail {

/// Whether every value is finite.
inline bool all_finite(std::span<const double> values) noexcept {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace slalom::detail
