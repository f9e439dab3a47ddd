#pragma once

#include "slalom/sim/track.hpp"

namespace slalom::sim::detail {

/// Returns the distance (m) that f1tenth_gym takes for that to the nearest wall, at a point of the map frame.
double gym_distance(const Track& track, const maps::Point& point);

}  // namespace slalom::sim::detail
