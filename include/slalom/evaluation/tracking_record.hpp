#pragma once

#include <vector>

#include "slalom/evaluation/lap_figures.hpp"

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
  int in_view = 0, detected = 0, long_in_view = 0, long_detected = 0, false_objects = 0;
  double position_error = 0, speed_error = 0, yaw_error = 0;  ///< m, m/s, rad
  double update_p99 = 0;                                      ///< ms
};
/// Calls `visit(field, Figure)` for every figure in the order of tables.
template <class Figures, class Visit>
requires std::derived_from<std::remove_const_t<Figures>, TrackingFigures>
void visit_figures(Figures& f, Visit&& visit) {
  visit(f.in_view, Figure{"tracking_in_view", "", "bodies in view, summed over control steps"});
  visit(f.detected, Figure{"tracking_detected", "", "detected ones of these"});
  visit(f.long_in_view,
        Figure{"tracking_long_in_view", "", "bodies that have been in view for 0.2 s without a break"});
  visit(f.long_detected, Figure{"tracking_long_detected", "", "detected ones of these"});
  visit(f.false_objects,
        Figure{"tracking_false_objects", "", "objects that were reported as seen where no body is"});
  visit(f.position_error, Figure{"tracking_position_error", "m", "root mean square over tracking_detected"});
  visit(f.speed_error, Figure{"tracking_speed_error", "m/s", "root mean square over tracking_detected"});
  visit(f.yaw_error,
        Figure{"tracking_yaw_error", "rad", "the same; of a body that stands, to the nearer of its ends"});
  visit(f.update_p99, Figure{"tracking_update_p99", "ms", "99th percentile of the time of an update", true});
}

/// The same figures with the times of the tracker.
struct TrackingRecord : TrackingFigures {
  std::vector<float> update_ms;  ///< wall-clock time of each update
};

}  // namespace slalom::evaluation
