#pragma once

#include <optional>

#include "vehicle/racing/free_space.hpp"

namespace slalom::vehicle::detail {

/// A closed way through the free space of a map, at least `keep` (m) from all walls: of those that lead round
/// an island of the map, each far from walls where it can be, the one that is longest for its width; with
/// `near`, of those that pass there. Free space that reaches the border of the map is the surroundings, and
/// only used if there is no other. Empty if there is none. Centres of cells, m, map frame, counter-clockwise.
/// `rival` becomes a point of another way that is nearly as long for its width.
std::vector<maps::Point> find_loop(const FreeSpace& space, double keep,
                                   const std::optional<maps::Point>& near, std::optional<maps::Point>& rival);

}  // namespace slalom::vehicle::detail
