#pragma once

#include <span>
#include <vector>

#include "slalom/sim/shapes.hpp"
#include "slalom/sim/track.hpp"

/// Obstacles that no car can pass, so that they can be counted separately.
namespace slalom::evaluation {

/// The options of impassable_obstacles.
struct PassabilityOptions {
  double radius = 0.155;  ///< m, of the disc that must pass: half the width of the car
  double reach = 3;  ///< m along the course, from which point before an obstacle to which point behind it
  double window =
      6;  ///< m around the obstacle that is searched, so that the course is not driven the other way
};

/// The indices of the bodies that block the road: no disc of the given radius can pass them. The search is a
/// flood fill over the cells of the map that treats a cell as free if any point in it may be free. So no car
/// of that width can pass a body that is returned; a car with a limited turning circle may fail at others
/// too. All bodies are present at once: two that block the road together are both returned. Empty on a track
/// without a lap path.
std::vector<int> impassable_obstacles(const sim::Track& track, std::span<const sim::Box> bodies,
                                      const PassabilityOptions& options = {});

}  // namespace slalom::evaluation
