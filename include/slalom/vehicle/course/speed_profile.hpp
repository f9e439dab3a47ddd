#pragma once

#include <vector>

namespace slalom::vehicle {

/// What a car's tyres, motor and brakes allow. All > 0.
struct SpeedLimits {
  double top_speed = 6.0;             ///< m/s
  double lateral_acceleration = 4.5;  ///< m/s^2
  double acceleration = 3.0;          ///< m/s^2
  double braking = 3.0;               ///< m/s^2
};

/// The highest speeds (m/s) along a closed path of the given curvatures (1/m), points `step` m apart, such
/// that
///
///   v <= top_speed,   v^2 |k| <= a_lat,   -braking * g <= dv/dt <= acceleration * g,   g = sqrt(1 - (v^2 k /
///   a_lat)^2):
///
/// the tyres' force is shared between turning and accelerating. One pass forward and one backward from the
/// slowest point. Source: Heilmeier et al. 2020 (see raceline.hpp), Sec. 4. Throws std::invalid_argument for
/// limits or a step that are not finite and above 0.
std::vector<double> speed_profile(const std::vector<double>& curvature, double step,
                                  const SpeedLimits& limits);

}  // namespace slalom::vehicle
