#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace slalom::maps {

/// A point of the path that the car is to follow.
struct ReferencePoint {
  double x = 0;      ///< m
  double y = 0;      ///< m
  double yaw = 0;    ///< rad, the path's direction there
  double speed = 0;  ///< m/s
};

/// The result of a look-up in a reference map: one 16-byte cell, so that one load fetches it.
struct ReferenceCell {
  float distance;  ///< m to the path
  float yaw;       ///< rad, yaw of the path at its nearest place
  float speed;     ///< m/s there
  float outside;   ///< 1 off the map (then `yaw` is the yaw ERROR to assume), else 0, or negative where the
                   ///< map knows the path's curvatures (see ReferenceField::set_curvatures)
};
static_assert(sizeof(ReferenceCell) == 16);

/// Throws std::invalid_argument, naming the point, unless there are 3 to 10 million points within PoseLimits,
/// of a finite speed >= 0, along a way of at least 0.1 m, at most 10,000 points a metre.
void check_reference_path(std::span<const ReferencePoint> path);

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
