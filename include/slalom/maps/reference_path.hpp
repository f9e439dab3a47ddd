#pragma once

#include <span>

#include "slalom/core/options.hpp"

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

/// The result of a look-up off a reference map.
/// `visit_reference_outside` below describes the fields.
struct ReferenceOutside {
  double distance = 20;
  double yaw = 2.0;  ///< The value of the paper's program (proj-svg_mppi).
  double speed = 0;
};

/// Declares the fields of `outside`, for the visit_options of the maps that have one.
template <class Outside, class Visit>
void visit_reference_outside(Outside& outside, Visit&& visit) {
  visit(outside.distance, {"outside_distance", "m", "distance to the path off the map", -1e30, 1e30});
  visit(outside.yaw, {"outside_yaw", "rad", "yaw error off the map", -7, 7});
  visit(outside.speed, {"outside_speed", "m/s", "speed of the path off the map", -1e3, 1e3});
}

/// Throws std::invalid_argument, naming the point, unless there are 3 to 10 million points, all within
/// 1e7 m of the origin along each axis, with a finite yaw and a finite speed >= 0.
void check_reference_path(std::span<const ReferencePoint> path);

}  // namespace slalom::maps
