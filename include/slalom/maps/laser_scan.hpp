#pragma once

#include <cstddef>
#include <numbers>
#include <span>

namespace slalom::maps {

/// A LiDAR scan that somebody else owns. Beam i points along angle_min + i * angle_increment,
/// counter-clockwise, in the frame of the laser.
struct LaserScanView {
  std::span<const float> ranges{};  ///< m; NaN, 0, infinite or beyond the limits where there is no reading
  double angle_min = 0;             ///< rad
  double angle_increment = 0;       ///< rad
  double range_min = 0;             ///< m; readings below it are ignored
  double range_max = 0;             ///< m; readings of it or more mean that nothing was hit
};

/// The angle (rad) of a beam of a scan whose `count` beams are evenly spread around the scanner, from its x
/// axis on, counter-clockwise.
inline double beam_angle(std::size_t beam, std::size_t count) {
  return 2 * std::numbers::pi * static_cast<double>(beam) / static_cast<double>(count);
}

}  // namespace slalom::maps
