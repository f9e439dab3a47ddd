#pragma once

#include <span>
#include <vector>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/closed_discs.hpp"
#include "slalom/maps/grid_search.hpp"
#include "slalom/maps/recovery.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {

/// Finds a path around an obstacle on the course, by a search in the map of obstacles. A plan looks only one
/// horizon ahead, so a dead end beside the obstacle can look better to it than the open side.
///
/// The search covers a grid around the car (maps::GridSearch). The car is a disc of its width and margin, and
/// cells near obstacles cost more. The search ends at the furthest point of the course in the grid that can
/// be reached; from there the path follows the course. After construction nothing allocates.
class Detour {
 public:
  /// Takes the course, whether it is closed, and the body of the car.
  Detour(std::span<const maps::ReferencePoint> course, bool closed, const BodyOptions& body);

  /// Notes the state of the recovery and the pose of the car (frame of the course). Call it once per control
  /// period. A place where the car had to reverse on a detour counts as a dead end in later searches, until
  /// the car is past it.
  void note(const maps::Recovery& recovery, const maps::Pose& pose) noexcept;

  /// Searches from `pose` (frame of the course) in the map of obstacles around it. `nearest` is the point of
  /// the course nearest to the car. Returns whether there is a path.
  bool search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest) noexcept;

  /// The path of the last search that found one; the speeds of a 1/10-scale car are at most 1.5 m/s.
  std::span<const maps::ReferencePoint> path() const noexcept { return path_; }
  /// Computes the field of the path around a position (m).
  void update_field(const maps::Pose& pose) noexcept { field_.update(pose); }
  /// The field of the path, as of the last `update_field`.
  const maps::ReferenceField& field() const noexcept { return field_; }

 private:
  void set_prices(const maps::ClearanceMap& obstacles, const maps::Pose& pose) noexcept;
  int furthest_reached(const maps::Pose& pose, int nearest) const noexcept;
  void follow_course(int from) noexcept;
  /// The number of points of the course from this one on.
  std::size_t points_from(std::size_t first) const noexcept {
    return closed_ ? course_.size() : course_.size() - first;
  }

  std::vector<maps::ReferencePoint> course_;
  bool closed_;
  double front_;   ///< m, from the pose to the car's front
  double needed_;  ///< m, from the car's middle to an obstacle
  CarScale scale_;
  double speed_limit_;  ///< m/s
  maps::GridSearch grid_;
  ReservedVector<maps::ReferencePoint> path_;
  maps::ReferenceField field_;
  maps::ClosedDiscs dead_ends_;
  bool on_detour_ = false;  ///< the car followed the path in the last control period
};

}  // namespace slalom::vehicle::detail
