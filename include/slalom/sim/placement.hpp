#pragma once

#include <span>

#include "slalom/maps/pose.hpp"
#include "slalom/sim/car.hpp"

namespace slalom::sim {

/// Returns the poses of parked cars at random places of a path, as the evaluation of K. Honda et al.
/// (proj-svg_mppi) draws them: car i by a fresh generator seeded with seed + i, at a waypoint drawn at
/// random, moved by up to 0.1 m (the distance, not the area, is uniform), with any yaw. The draws are those
/// of numpy, bit for bit. Cars may overlap each other and may close the road. Throws std::invalid_argument on
/// an empty path and on a number of cars outside [0, 10000].
std::vector<maps::Pose> place_at_random(std::span<const maps::Point> path, int cars, std::uint64_t seed);

/// Returns the poses of parked cars of the size of `car` that leave the course passable: with one and a half
/// metres between any two, three to the start, and a passage of 0.6 m beside each. These lengths are for a
/// width of 0.31 m and grow with that of the car. `room` gives for each waypoint the distance (m) to the
/// nearest wall, or is empty where this is not known. Throws std::invalid_argument as place_at_random does
/// and on a `room` of another size than `path`, and std::runtime_error if 2000 draws do not suffice.
std::vector<maps::Pose> place_apart(std::span<const maps::Point> path, std::span<const double> room, int cars,
                                    std::uint64_t seed, const maps::Point& start,
                                    const CarParameters& car = {});

}  // namespace slalom::sim
