#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

namespace slalom::maps {

/// The index of the point of a path at which a vehicle is: the nearest point, or, where the path passes
/// several times within 1 m more of the vehicle, as where it crosses itself, the nearest point of one of
/// these parts: the part with the point `last` if the vehicle faces along it, else the one whose distance and
/// direction fit best. `squared_to(i)` is the squared distance (m^2) from the vehicle to point i of `count`,
/// which follow each other in a circle, `turned(i)` the vehicle's yaw (rad) from the path's direction there,
/// and `last` the place before, or `count`.
template <class SquaredTo, class Turned>
std::size_t place_on_path(std::size_t count, const SquaredTo& squared_to, const Turned& turned,
                          std::size_t last) noexcept {
  constexpr double none = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0, first = 0;
  double least = none;
  for (std::size_t i = 0; i < count; ++i) {
    const double squared = squared_to(i);
    if (squared >= least) continue;
    least = squared;
    nearest = i;
  }
  const double reach = std::sqrt(least) + 1, within = reach * reach;
  while (first < count && squared_to(first) <= within) ++first;
  std::size_t place = nearest;
  double best = none;
  for (std::size_t k = first == count ? count : 1; k < count; ++k) {
    std::size_t at = nearest;
    double squared = none;
    bool was_here = false;
    for (; k < count; ++k) {
      const std::size_t i = (first + k) % count;
      const double here = squared_to(i);
      if (here > within) break;
      was_here = was_here || i == last;
      if (here >= squared) continue;
      squared = here;
      at = here > least ? i : nearest;
    }
    if (squared == none) continue;
    // Else the mean of the squared distances of the two ends of a metre along the vehicle and along the path,
    // but for what the order of the parts does not depend on.
    const double unlike = 1 - std::cos(turned(at)), error = was_here && unlike < 1 ? -1 : squared + unlike;
    if (error >= best) continue;
    best = error;
    place = at;
  }
  return place;
}

}  // namespace slalom::maps
