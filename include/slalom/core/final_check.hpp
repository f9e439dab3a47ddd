#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

/// The final check of a control sequence before it leaves the library.
namespace slalom {

/// Bounds of the inputs, [input]: finite values with `low` <= `high`, or infinities without a bound.
struct InputBounds {
  InputBounds() = default;
  /// No bounds.
  explicit InputBounds(int inputs)
      : low(static_cast<std::size_t>(inputs), -std::numeric_limits<double>::infinity()),
        high(static_cast<std::size_t>(inputs), std::numeric_limits<double>::infinity()) {}

  std::vector<double> low;   ///< least value of each input
  std::vector<double> high;  ///< largest value of each input

  /// The value within the bounds of `input` that is nearest to `value`, or to 0 if `value` is not a number.
  double nearest(std::size_t input, double value) const noexcept {
    return std::clamp(std::isnan(value) ? 0.0 : value, low[input], high[input]);
  }
};

/// Makes the inputs `u` of a step valid: finite, within the bounds, and no further than `reach(input)` from
/// those of the step before. A value that is not finite becomes that of the step before. A reach that is
/// negative or not a number counts as 0. `previous` must be valid and becomes `u`. Returns the number of
/// values that were changed.
template <class Reach>
int check_inputs(std::span<double> u, std::span<double> previous, const InputBounds& bounds,
                 Reach&& reach) noexcept {
  int changed = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double before = previous[i], stated = reach(i), most = stated >= 0 ? stated : 0;
    const double wanted = std::isfinite(u[i]) ? u[i] : before;
    const double valid =
        std::clamp(wanted, std::max(bounds.low[i], before - most), std::min(bounds.high[i], before + most));
    changed += static_cast<float>(valid) != static_cast<float>(u[i]);  // solvers work in float32
    previous[i] = u[i] = valid;
  }
  return changed;
}

/// Replaces a cost that is infinite or not a number by the largest double. Returns 1 if so, otherwise 0.
inline int check_cost(double& cost) noexcept {
  if (std::isfinite(cost)) return 0;
  cost = std::numeric_limits<double>::max();
  return 1;
}

}  // namespace slalom
