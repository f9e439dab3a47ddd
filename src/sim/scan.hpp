#pragma once

#include <span>

#include "slalom/sim/lidar.hpp"

namespace slalom::sim::detail {

/// Beams that are walked together as far as no wall is near any of them. Direction arrays are padded to whole
/// cones.
inline constexpr int cone_beams = 16;

/// Unit vectors in the sensor's frame, one per beam.
struct Directions {
  std::span<const float> cosines, sines;
};

/// The exact scan of walls.
void scan(const Track& track, const maps::Pose& sensor, const LidarOptions& options, const Directions& beams,
          std::span<double> ranges);

}  // namespace slalom::sim::detail
