#pragma once

#include <span>
#include <vector>

#include "slalom/sim/shapes.hpp"
#include "slalom/sim/track.hpp"

/// Obstacles that nobody could have driven past, so that they can be counted apart.
namespace slalom::evaluation {

/// What the search takes for granted.
struct PassabilityOptions {
  double radius =
      0.155;          ///< m, half the car's width: the disc about a point of its axle that must get through
  double reach = 3;   ///< m along the course: from so far before an obstacle to so far behind it
  double window = 6;  ///< m round the obstacle: what is searched, so that the way round a loop is none
};

/// The bodies, by their index, that close the road: no disc of the given radius comes past them, by a search
/// over the cells of the map that takes every cell for free of which any point may be. So what is named here
/// cannot be passed by any car of that width; a car that must turn may fail elsewhere too. Bodies stand all
/// together: two that close the road with each other are both named. None on a track without a lap path.
std::vector<int> impassable_obstacles(const sim::Track& track, std::span<const sim::Box> bodies,
                                      const PassabilityOptions& rules = {});

}  // namespace slalom::evaluation
