#pragma once

#include <span>

namespace slalom::maps {

/// A point of the path that the car is to follow.
struct ReferencePoint {
  double x = 0;      ///< m
  double y = 0;      ///< m
  double yaw = 0;    ///< rad, the path's direction there
  double speed = 0;  ///< m/s
};

/// The result of a look-up in a reference map: one 16-byte cell, so that one load fetches it.
struct ReferenceCell {
  float distance;  ///< m to the path
  float yaw;       ///< rad, yaw of the path at its nearest place
  float speed;     ///< m/s there
  float outside;   ///< 1 off the map (then `yaw` is the yaw ERROR to assume), else 0, or negative where the
                   ///< map knows the path's curvatures (see ReferenceField::set_curvatures)
};
static_assert(sizeof(ReferenceCell) == 16);

/// Throws std::invalid_argument, naming the point, unless there are 3 to 10 million points within PoseLimits,
/// of a finite speed >= 0, along a way of at least 0.1 m, at most 10,000 points a metre.
void check_reference_path(std::span<const ReferencePoint> path);

}  // namespace slalom::maps
