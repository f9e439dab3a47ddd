#pragma once

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "tracking/readings.hpp"

namespace slalom::tracking {

/// The part of a scan that the map explains.
class MapBackground {
 public:
  /// Throws std::invalid_argument on maps that ObjectTracker excludes.
  explicit MapBackground(const maps::OccupancyGrid& map);

  /// m, from a point to the outline of the nearest occupied or unknown cell; negative in such a cell, 0
  /// outside the map. Bilinear between the centres of cells.
  double distance(const maps::Point& point) const noexcept;

  /// The pose of the sensor at which the scan fits the map best, near one that is known with the given
  /// standard deviations (m, rad): Gauss-Newton steps on the distances of some readings to the map, as in A.
  /// W. Fitzgibbon, "Robust registration of 2D and 3D point sets", Image and Vision Computing 21, 2003, with
  /// the weights of Geman & McClure against readings of objects.
  maps::Pose align(const Readings& readings, const maps::Pose& sensor, double position_deviation,
                   double yaw_deviation, double range_deviation) const noexcept;

 private:
  struct Slope {
    double distance, x, y;  ///< m, and its derivatives in the map frame
  };
  Slope slope(const maps::Point& point) const noexcept;
  double cell(int column, int row) const noexcept;

  int width_, height_;
  double resolution_;
  maps::Pose origin_;
  double cosine_, sine_;         ///< direction of the origin's yaw
  std::vector<float> distance_;  ///< m, height x width
};

}  // namespace slalom::tracking
