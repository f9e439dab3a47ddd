#pragma once

#include <vector>

namespace slalom::evaluation {

/// Whether a tracker of other cars runs on the scans of a lap, and on which pose. With a map, the planner is
/// given what its objects will do.
enum class TrackingMode {
  automatic,  ///< with other cars that the planner predicts: on the pose that it is given; else off
  off,
  exact,      ///< tracker with the map and the true pose
  localised,  ///< tracker with the map and the pose of a localiser, which has scans and wheel odometry
  mapless,    ///< tracker without the map, with the pose of wheel odometry and gyro
};
inline const char* const* enum_names(TrackingMode) {
  static constexpr const char* names[] = {"automatic", "off", "exact", "localised", "mapless", nullptr};
  return names;
}

/// The objects of a tracker (tracking::ObjectTracker) compared with the bodies of the simulated world, in
/// every control step. A body is in view if at least five beams hit it, without their noise, and its middle
/// is at most 8 m from the LiDAR. Without a map a body counts only while it moves at 0.5 m/s or more. It is
/// detected if an object is at most 0.5 m from its middle. Figures of positions include the error of the
/// localisation, but not the drift of the wheel odometry.
struct TrackingFigures {
  int in_view = 0;            ///< bodies in view, summed over control steps
  int detected = 0;           ///< detected ones of these
  int long_in_view = 0;       ///< bodies that have been in view for 0.2 s without a break
  int long_detected = 0;      ///< detected ones of these
  int false_objects = 0;      ///< objects that were reported as seen where no body is
  double position_error = 0;  ///< m, root mean square over `detected`
  double speed_error = 0;     ///< m/s, the same
  double yaw_error = 0;       ///< rad, the same; of a body that stands, to the nearer of its ends
  double update_p99 = 0;      ///< ms, wall-clock, of an update; column `wall_tracking_p99`
};

/// The same figures with the times of the tracker.
struct TrackingRecord : TrackingFigures {
  std::vector<float> update_ms;  ///< wall-clock time of each update
};

}  // namespace slalom::evaluation
