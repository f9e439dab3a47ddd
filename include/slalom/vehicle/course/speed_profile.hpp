#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::vehicle {

/// The limits of a car's tyres, motor and brakes. All > 0.
struct SpeedLimits {
  double top_speed = 6.0;             ///< m/s
  double lateral_acceleration = 4.5;  ///< m/s^2
  double acceleration = 3.0;          ///< m/s^2
  double braking = 3.0;               ///< m/s^2
};

/// The limits of a car on ground of this friction coefficient: no acceleration above `friction` g, and none
/// above the limits of motor (`acceleration`) and brakes (`braking`, both m/s^2).
SpeedLimits grip_limits(double friction, double top_speed, double acceleration, double braking);

/// The highest speeds v (m/s) along a path, nowhere above `speed`, such that
///
///   v <= top_speed,   v^2 |k| <= a_lat,   -braking * g <= dv/dt <= acceleration * g,   g = sqrt(1 - (v^2 k /
///   a_lat)^2):
///
/// the tyres' force is shared between turning and accelerating. One pass forward and one backward from the
/// slowest point. Source: Heilmeier et al. 2020 (see raceline.hpp), Sec. 4. `speed` and `curvature` (k, 1/m)
/// have one entry per point, and `step[i]` is the way (m) from point i to the next, from the last to the
/// first; that of an open path is not used. Throws std::invalid_argument for limits that are not finite and
/// above 0, and for sizes that differ.
std::vector<double> feasible_speeds(std::span<const double> speed, std::span<const double> curvature,
                                    std::span<const double> step, bool closed, const SpeedLimits& limits);

/// The geometry of a polyline, on which its profile depends.
struct PathGeometry {
  bool closed = true;             ///< whether the first point follows the last one
  std::vector<double> step;       ///< m, from each point to the next, from the last to the first
  std::vector<double> curvature;  ///< 1/m at each point, > 0 to the left
};

/// Steps and curvatures of a path. The curvature is the change of direction between the chords of at least
/// 0.4 m before and after the point, over their mean length, so that rounded coordinates and uneven steps do
/// not show. Without `closed` a path is closed if its ends are at most three of its longest steps apart.
/// Successive points must differ.
PathGeometry path_geometry(std::span<const maps::Point> points, std::optional<bool> closed = {});

}  // namespace slalom::vehicle
