#pragma once

#include <span>

#include "slalom/sim/lidar.hpp"

namespace slalom::sim::detail {

/// The directions that f1tenth_gym takes for one beam after the other.
class GymDirections {
 public:
  GymDirections(double yaw, const LidarOptions& options);
  /// Cosine and sine.
  maps::Point next();

 private:
  double index_, increment_;
};

/// The scan of f1tenth_gym, with the directions that `options` ask for; `angles` are those of the beams.
void gym_scan(const Track& track, const maps::Pose& sensor, const LidarOptions& options,
              std::span<const double> angles, std::span<double> ranges);

/// Its distance (m) at a point of the map frame.
double gym_distance(const Track& track, const maps::Point& point);

}  // namespace slalom::sim::detail
