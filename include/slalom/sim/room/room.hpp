#pragma once

#include <span>

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {

/// A rectangular floor from (0, 0) to (length, width) with walls, which are on its map, and with
/// obstacles (such as pallets) and people (moved by a Crowd), which are not.
struct Room {
  double length = 0;           ///< m, along x
  double width = 0;            ///< m, along y
  std::vector<Box> walls;      ///< besides those around the floor
  std::vector<Box> obstacles;  ///< not on the map
  std::vector<Disc> people{};  ///< present places of people, who are not on the map
  std::vector<Disc> posts{};   ///< round obstacles, not on the map
};

/// The map of a room: its walls, and one cell of wall around the floor. Throws std::invalid_argument unless
/// the room has 1 to 1000 m along each side and the resolution (m) is in [0.01, 1].
maps::OccupancyGrid map_of(const Room& room, double resolution);

/// Whether a body overlaps a wall, an obstacle or a person, or leaves the floor. Exact.
bool collides(const Room& room, const Box& body) noexcept;

/// Writes the distances (m) that a scanner measures, one for each of `ranges`, evenly spread around it from
/// its x axis on; at most `max_range`. The scanner must be on the floor.
void scan(const Room& room, const maps::Pose& scanner, double max_range, std::span<double> ranges) noexcept;

}  // namespace slalom::sim
