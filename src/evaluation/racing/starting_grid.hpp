#pragma once

#include <span>
#include <vector>

#include "slalom/evaluation/grid_race.hpp"

namespace slalom::evaluation {

/// Where the cars of a race start (centres of gravity), the first place at arc length `line` (m), the others
/// behind it. Places with less than 0.1 m to a wall are moved back. Throws std::runtime_error if there is no
/// room on a quarter of the course.
std::vector<maps::Pose> starting_grid(const Environment& environment, double line, int cars,
                                      const sim::CarParameters& car, const GridRaceOptions& options);

/// The indices of cars in the order of the standings: those that finished by time, then the others by their
/// progress. The grid decides between equals.
std::vector<int> standings_of(std::span<const CarResult> cars);

}  // namespace slalom::evaluation
