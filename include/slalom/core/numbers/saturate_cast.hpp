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
  constexpr Real least = static_cast<Real>(Limits::min());
  constexpr Real beyond = 2 * static_cast<Real>((Limits::max() >> 1) + 1);  // a power of two, exact in `Real`
  if (value >= beyond) return Limits::max();
  if (value > least) return static_cast<Whole>(value);
  return value <= least ? Limits::min() : if_nan;
}

}  // namespace slalom
