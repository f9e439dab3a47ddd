#pragma once

#include <memory>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "slalom/tracking/tracker_options.hpp"

/// Detects other cars around a LiDAR, and follows them from scan to scan.
///
///     ObjectTracker tracker(course.map);
///     while (driving) {
///       const TrackerOutput& seen = tracker.update({scan, sensor_pose, stamp});
///       for (const TrackedObject& object : seen.objects) avoid(object);
///     }
///
/// 1. With a map, readings that are not near its obstacles belong to objects; an uncertain pose is first
///    corrected by aligning the scan with the map. Without one, an object is what enters space that an
///    earlier scan saw as free, or leaves space that is free now (C.-C. Wang, C. Thorpe et al.,
///    "Simultaneous localization, mapping and moving object tracking", IJRR 26(9), 2007, section 5).
/// 2. Clusters end where the distance between neighbouring readings is above the adaptive threshold of
///    G. A. Borges & M.-J. Aldon, "Line extraction in 2D range images for mobile robotics", J. of Intelligent
///    and Robotic Systems 40, 2004, eq. 1.
/// 3. Each reading goes to the object in whose gate it is most likely, so that cars side by side share one
///    cluster and a car behind another may have several.
/// 4. Boxes are fitted by the search of X. Zhang, W. Xu, C. Dong & J. M. Dolan, "Efficient L-shape fitting
///    for vehicle detection using laser scanners", IEEE IV 2017, algorithms 2 and 4 (closeness). The centre
///    follows from the sides in view; an end that something hides says nothing.
/// 5. An extended Kalman filter for constant turn rate and speed predicts and corrects each object
///    (R. Schubert, E. Richter & G. Wanielik, "Comparison and evaluation of advanced motion models for
///    vehicle tracking", FUSION 2008). A new object has constant velocity until it is confirmed.
/// 6. An object is confirmed by several scans. It is dropped when scans see through its place, or when it
///    was out of view for too long.
namespace slalom::tracking {

/// How an update ended.
enum class TrackerStatus {
  ok,
  bad_scan,  ///< empty, too long or of invalid geometry: the objects were only predicted
  misfit,    ///< much of the scan ends behind walls of the map, so the pose is wrong: the objects were only
             ///< predicted
  bad_pose,  ///< pose or stamp not finite: ignored
  stale,     ///< not later than the last update, by less than 1 s: ignored
};

/// The input of an update.
struct TrackerInput {
  maps::LaserScanView scan;  ///< scan in the frame of the LiDAR
  maps::Pose sensor;  ///< pose of the LiDAR: in the map frame; without a map in any frame that is at rest
  double stamp = 0;   ///< s, of the scan
  double position_deviation =
      0;                     ///< m, of x and of y; where 0 and with a yaw deviation of 0 the pose is exact
  double yaw_deviation = 0;  ///< rad
};

/// An object. Its pose is in the frame in which TrackerInput::sensor is given (with a map, the map's frame).
/// The order of the state in `covariance` is x, y, yaw, speed, yaw rate.
struct TrackedObject {
  int id = 0;                    ///< stays with the object; from 1
  maps::Pose pose;               ///< pose of the middle of its box
  double speed = 0;              ///< m/s, along the yaw
  double yaw_rate = 0;           ///< rad/s
  double length = 0;             ///< m
  double width = 0;              ///< m
  double covariance[5][5] = {};  ///< covariance of the state (m, m, rad, m/s, rad/s)
  double unseen = 0;             ///< s since it was last seen; 0 if this scan has readings of it
};

/// The result of an update. `objects` is valid until the next one.
struct TrackerOutput {
  TrackerStatus status = TrackerStatus::ok;  ///< how the update ended
  std::span<const TrackedObject> objects;    ///< confirmed objects, ascending by id
  /// The pose of the LiDAR at the last scan that was used (status `ok` or `misfit`), aligned with the map.
  maps::Pose sensor;
  double update_time = 0;  ///< s of wall clock
};

/// Detects and follows objects. After construction nothing allocates or throws. The time of an update is
/// bounded by `max_beams` and `max_objects`. The same inputs give the same bits on one machine.
class ObjectTracker {
 public:
  /// Tracks without a map: moving things are objects. Throws std::invalid_argument on options out of range.
  explicit ObjectTracker(const TrackerOptions& options = {});
  /// Tracks with a map, which it copies: things that are not on it are objects. Unknown cells hide objects.
  /// Throws std::invalid_argument on options out of range, and on a map that has not width x height cells, at
  /// least one, whose origin is not finite, or whose resolution is not finite and above 0.
  explicit ObjectTracker(const maps::OccupancyGrid& map, const TrackerOptions& options = {});
  ~ObjectTracker();
  ObjectTracker(const ObjectTracker& other);  ///< copies the objects and scans; copies share the map
  ObjectTracker& operator=(const ObjectTracker& other);
  ObjectTracker(ObjectTracker&&) noexcept;  ///< moves; the source can only be destroyed or assigned to
  ObjectTracker& operator=(ObjectTracker&&) noexcept;

  /// Predicts all objects to `input.stamp` and corrects them with the scan.
  const TrackerOutput& update(const TrackerInput& input) noexcept;
  void reset() noexcept;                           ///< forgets all objects and scans
  const TrackerOptions& options() const noexcept;  ///< the options given at construction

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace slalom::tracking
