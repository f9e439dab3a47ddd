#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace slalom::vehicle::detail {

/// One pass forward and one backward along a line of points with these speeds. `forwards` and `backwards`
/// take the points at which a piece of it begins and ends as they drive it, and its length (m); they may
/// lower the speed of the second. `step[i]` is the way (m) from point i to the next, from the last to the
/// first.
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

/// Lowers speeds (m/s) to what a car reaches from point to point, by one pass forward and one backward.
/// `forwards` and `braking` return the strongest acceleration (m/s^2) at a speed (m/s) and a curvature (1/m);
/// that at the start of a piece holds for all of it.
template <class Forwards, class Braking>
void lower_to_reachable(std::vector<double>& speed, std::span<const double> curvature,
                        std::span<const double> step, bool closed, const Forwards& forwards,
                        const Braking& braking) {
  const auto pass = [&](const auto& strongest) {
    return [&](std::size_t from, std::size_t to, double way) {
      const double a = strongest(speed[from], curvature[from]);
      speed[to] = std::min(speed[to], std::sqrt(speed[from] * speed[from] + 2 * a * way));
    };
  };
  for_each_piece(speed, step, closed, pass(forwards), pass(braking));
}

/// The same, with the strongest acceleration of both ends of a piece and of its middle: on a line on which
/// turning takes all grip almost everywhere, that of the start alone is too much for a fifth of the pieces.
template <class Forwards, class Braking>
void lower_to_reachable_throughout(std::vector<double>& speed, std::span<const double> curvature,
                                   std::span<const double> step, bool closed, const Forwards& forwards,
                                   const Braking& braking) {
  const auto pass = [&](const auto& strongest) {
    return [&](std::size_t from, std::size_t to, double way) {
      const double before = speed[from], first = curvature[from], last = curvature[to];
      const auto holds = [&](double after) {
        const double a = (after * after - before * before) / (2 * way);
        return a <= strongest(before, first) && a <= strongest(after, last) &&
               a <= strongest(0.5 * (before + after), 0.5 * (first + last));
      };
      if (speed[to] <= before || holds(speed[to])) return;
      double low = before, high = speed[to];
      for (int k = 0; k < 50; ++k) {
        const double middle = 0.5 * (low + high);
        (holds(middle) ? low : high) = middle;
      }
      speed[to] = low;
    };
  };
  for_each_piece(speed, step, closed, pass(forwards), pass(braking));
}

/// The share of the tyres' force that is left for accelerating when turning at `speed`, 0..1.
inline double share_left(double speed, double curvature, double lateral_acceleration) {
  const double used = speed * speed * curvature / lateral_acceleration;
  return std::sqrt(std::max(0.0, 1 - used * used));
}

}  // namespace slalom::vehicle::detail
