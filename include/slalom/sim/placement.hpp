#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slalom/maps/pose.hpp"
#include "slalom/sim/car.hpp"

namespace slalom::sim {

/// A car's place and the waypoint near which it was put.
struct Placement {
  maps::Pose pose;           ///< m, m, rad, in the map frame
  std::size_t waypoint = 0;  ///< row of the path
};

/// Parked cars at random places of a path, as the evaluation of K. Honda et al. (proj-svg_mppi) draws them:
/// car i by a fresh generator seeded with seed + i, at a waypoint drawn at random, moved by up to `radius`
/// (m; the distance, not the area, is uniform), with any yaw. The draws are those of numpy, bit for bit. Cars
/// may overlap each other and may close the road. Throws std::invalid_argument on an empty path, a number of
/// cars outside [0, 10000], or a radius outside [0, 1000].
std::vector<Placement> place_at_random(std::span<const maps::Point> path, int cars, std::uint64_t seed,
                                       double radius = 0.1);

/// The rules by which place_apart places cars.
struct PlacementRules {
  double radius = 0.1;      ///< m, most distance from the waypoint, uniform over the disc
  double length = 0.58;     ///< m, of a car
  double width = 0.31;      ///< m
  double gap = 1.5;         ///< m, least room between two cars
  double keep_clear = 3.0;  ///< m, least distance of a car's middle from `start`
  double passage = 0.6;     ///< m, least room to a wall on one side of a car, if `room` is given
  int attempts = 2000;      ///< largest number of draws in total
};

/// The rules for cars of this size: all lengths grow with the width.
PlacementRules placement_of(const CarParameters& car);

/// Parked cars that leave the course passable: none overlaps another or is near the start, and a passage
/// beside each stays open. `room` gives for each waypoint the distance (m) to the nearest wall, or is
/// empty where this is not known. Throws std::invalid_argument as place_at_random does and on a `room` of
/// another size than `path`, and std::runtime_error if the attempts do not suffice.
std::vector<Placement> place_apart(std::span<const maps::Point> path, std::span<const double> room, int cars,
                                   std::uint64_t seed, const maps::Point& start,
                                   const PlacementRules& rules = {});

}  // namespace slalom::sim
