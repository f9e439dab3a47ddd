#pragma once

#include <span>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/moving_obstacles.hpp"

namespace slalom::maps {

/// Sets the readings of a scan that end on an obstacle as it is now to NaN, so that maps made of the scan do
/// not keep it where it was. `scan` has the geometry, with beams that run counter-clockwise, `ranges` its
/// readings (m), and `sensor` its pose in the frame of the obstacle. Readings within `margin` (m) of the
/// obstacle's box are on it. Does nothing where beams run clockwise or half a turn apart, or the obstacle has
/// no poses.
void drop_readings_of(const PredictedObstacle& obstacle, double margin, const Pose& sensor,
                      const LaserScanView& scan, std::span<float> ranges) noexcept;

}  // namespace slalom::maps
