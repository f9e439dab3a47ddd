#pragma once

#include <array>

namespace slalom::vehicle {

/// The covariance of a pose: of x, y (m, map frame) and yaw (rad). All 0 where it is not known.
using PoseCovariance = std::array<std::array<double, 3>, 3>;

}  // namespace slalom::vehicle
