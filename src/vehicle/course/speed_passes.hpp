#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace slalom::vehicle::detail {

/// One pass forward and one backward along a line of points with these speeds. `forwards` and `backwards`
/// take the points at which a piece of it begins and ends as they drive it, and its length (m); they may
/// lower the speed of the second. `step` has the ways (m) from each point to the next, the last to the first.
template <class Forwards, class Backwards>
void for_each_piece(const std::vector<double>& speed, std::span<const double> step, bool closed,
                    const Forwards& forwards, const Backwards& backwards) {
  const std::size_t n = speed.size();
  if (n == 0) return;
  // The slowest point of a closed path keeps its speed, so one pass from it is exact.
  const auto slowest =
      closed ? static_cast<std::size_t>(std::min_element(speed.begin(), speed.end()) - speed.begin()) : 0;
  const std::size_t steps = closed ? n : n - 1;
  for (std::size_t k = 0; k < steps; ++k) {
    const std::size_t from = (slowest + k) % n;
    forwards(from, (from + 1) % n, step[from]);
  }
  for (std::size_t k = steps; k > 0; --k) {
    const std::size_t to = (slowest + k - 1) % n;
    backwards((to + 1) % n, to, step[to]);
  }
}

/// The share of the tyres' force that is left for accelerating when turning at `speed`, 0..1.
inline double share_left(double speed, double curvature, double lateral_acceleration) {
  const double used = speed * speed * curvature / lateral_acceleration;
  return std::sqrt(std::max(0.0, 1 - used * used));
}

}  // namespace slalom::vehicle::detail
