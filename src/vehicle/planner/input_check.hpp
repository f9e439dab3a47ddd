#pragma once

#include <cmath>

#include "slalom/vehicle/planner/planner.hpp"

namespace slalom::vehicle::detail {

/// Whether odometry is a number and as large as that of a car may be.
inline bool plausible(const Odometry& o) {
  return std::abs(o.pose.x) <= Odometry::furthest && std::abs(o.pose.y) <= Odometry::furthest &&
         std::abs(o.pose.yaw) <= Odometry::max_yaw && std::abs(o.speed) <= Odometry::fastest;
}

}  // namespace slalom::vehicle::detail
