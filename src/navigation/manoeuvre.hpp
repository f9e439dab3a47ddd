#pragma once

#include <array>
#include <span>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/navigation/costmap.hpp"

namespace slalom::navigation::detail {

/// A way between two poses for a base that cannot turn on the spot: an arc, a straight or an arc, and an arc,
/// each driven forward or in reverse.
struct Manoeuvre {
  struct Part {
    double length = 0;  ///< m, negative in reverse
    int steering = 0;   ///< 1 to the left, -1 to the right, 0 straight
  };
  /// Limits of the base.
  struct Limits {
    double radius = 1;         ///< m, least of an arc
    bool can_reverse = false;  ///< whether it drives backward
  };
  std::array<Part, 3> parts;
  double radius = 1;  ///< m, of the arcs

  double cost() const noexcept;  ///< the length, and 0.5 m for each change between forward and reverse: m
  /// Appends poses at most 0.05 m apart from `from` on, without the last one. The yaws are those of the base.
  void append(const maps::Pose& from, std::vector<maps::Pose>& poses) const noexcept;
  /// Whether the body is free at all its poses.
  bool is_free(const maps::Pose& from, const Costmap& costmap, const Footprint& footprint) const noexcept;
};

/// The manoeuvre of least cost, below `most`, between two poses on which the body is free. Uses the words
/// C S C and C|C|C of J. Reeds and L. Shepp, "Optimal paths for a car that goes both forwards and backwards",
/// Pacific Journal of Mathematics 145 (1990). The cost is infinite if there is none.
Manoeuvre find_manoeuvre(const maps::Pose& from, const maps::Pose& to, const Manoeuvre::Limits& limits,
                         double most, const Costmap& costmap, const Footprint& footprint) noexcept;

}  // namespace slalom::navigation::detail
