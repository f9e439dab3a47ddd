#pragma once

#include <limits>
#include <type_traits>

namespace slalom {

/// A real number as a whole one: without its fraction, moved into the range of the type; `if_nan` for NaN,
/// such as -1 for no cell. A static_cast is undefined beyond the range, and script/checks/tidy refuses it.
template <class Whole, class Real>
requires std::is_floating_point_v<Real>
constexpr Whole saturate_cast(Real value, Whole if_nan = 0) noexcept {
  using Limits = std::numeric_limits<Whole>;
  constexpr Real beyond = 2 * static_cast<Real>(Limits::max() / 2 + 1);  // a power of two, exact in `Real`
  if (value != value) return if_nan;
  if (value <= static_cast<Real>(Limits::min())) return Limits::min();
  return value < beyond ? static_cast<Whole>(value) : Limits::max();
}

}  // namespace slalom
