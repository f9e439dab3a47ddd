#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace slalom::vehicle::detail {

/// Lowers speeds (m/s) to what a car reaches from point to point, by one pass forward and one backward.
/// `forwards` and `braking` return the strongest acceleration (m/s^2) at a speed (m/s) and a curvature (1/m).
/// `step[i]` is the way (m) from point i to the next, from the last to the first.
template <class Forwards, class Braking>
void lower_to_reachable(std::vector<double>& speed, std::span<const double> curvature,
                        std::span<const double> step, bool closed, const Forwards& forwards,
                        const Braking& braking) {
  const std::size_t n = speed.size();
  if (n == 0) return;
  const auto pass = [&](std::size_t from, std::size_t to, double way, const auto& strongest) {
    const double a = strongest(speed[from], curvature[from]);
    speed[to] = std::min(speed[to], std::sqrt(speed[from] * speed[from] + 2 * a * way));
  };
  // The slowest point of a closed path keeps its speed, so one pass from it is exact.
  const auto slowest =
      closed ? static_cast<std::size_t>(std::min_element(speed.begin(), speed.end()) - speed.begin()) : 0;
  const std::size_t steps = closed ? n : n - 1;
  for (std::size_t k = 0; k < steps; ++k) {
    const std::size_t from = (slowest + k) % n;
    pass(from, (from + 1) % n, step[from], forwards);
  }
  for (std::size_t k = steps; k > 0; --k) {
    const std::size_t to = (slowest + k - 1) % n;
    pass((to + 1) % n, to, step[to], braking);
  }
}

/// The share of the tyres' force that is left for accelerating when turning at `speed`, 0..1.
inline double share_left(double speed, double curvature, double lateral_acceleration) {
  const double used = speed * speed * curvature / lateral_acceleration;
  return std::sqrt(std::max(0.0, 1 - used * used));
}

}  // namespace slalom::vehicle::detail
