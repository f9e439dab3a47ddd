#pragma once

#include <optional>

#include "slalom/vehicle/racing/corridor.hpp"
#include "vehicle/racing/free_space.hpp"

namespace slalom::vehicle::detail {

/// The measures with which a corridor of a map is found.
struct CorridorMeasure {
  double keep = 0;          ///< m, that the centre of the car keeps from walls
  double step = 0;          ///< m between the points of the centre line
  double reach = 0;         ///< m, widths are at most this
  bool keeps_line = false;  ///< whether the car keeps to the line where no wall is within reach

  /// Whether nothing bounds the corridor at a point of its line.
  bool keeps(const FreeSpace& space, const maps::Point& at) const {
    return keeps_line && space.clearance(at) >= reach;
  }
};

/// The corridor along a line: at each point the widths to both sides up to where the car can be. A width ends
/// where another part of the line is nearer, so that normals of neighbours do not cross.
Corridor measured_corridor(const FreeSpace& space, const std::vector<maps::Point>& line, bool closed,
                           const CorridorMeasure& measure);

/// The same along a line in the middle between the walls. `line` gives the way, and may be rough. Throws
/// std::invalid_argument if the corridor is closed, and at least half of the points are not in free space.
Corridor centred_corridor(const FreeSpace& space, const std::vector<maps::Point>& line, bool closed,
                          const CorridorMeasure& measure);

/// A closed way through the free space of a map, at least `keep` (m) from all walls: of those that lead round
/// an island of the map, each far from walls where it can be, the one that is longest for its width; with
/// `near`, of those that pass there. Free space that reaches the border of the map is the surroundings, and
/// only used if there is no other. Empty if there is none. Centres of cells, m, map frame, counter-clockwise.
/// `rival` becomes a point of another way that is nearly as long for its width.
std::vector<maps::Point> find_loop(const FreeSpace& space, double keep,
                                   const std::optional<maps::Point>& near, std::optional<maps::Point>& rival);

}  // namespace slalom::vehicle::detail
