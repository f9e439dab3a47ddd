#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/clearance_map.hpp"
#include "slalom/maps/command.hpp"
#include "slalom/maps/leg_follower.hpp"
#include "slalom/maps/manoeuvre_search.hpp"
#include "slalom/maps/reference_path.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

namespace slalom::vehicle::detail {

/// The length of a body, m.
inline double length_of(const BodyOptions& body) {
  return body.front + body.rear;
}

/// Finds and drives a way of slow arcs, forwards and in reverse, to a place from which the car can follow its
/// path: a turn in three points, or out of a corner. A search takes some milliseconds, 50 at most where there
/// is no way, and only starts while the car stands. After construction nothing allocates.
class Manoeuvre {
 public:
  /// Takes the path, whether it is closed, the body of the car, its wheelbase (m) and the largest angle of
  /// the wheels (rad).
  Manoeuvre(std::span<const maps::ReferencePoint> path, bool closed, const BodyOptions& body,
            double wheelbase, double steer_limit);

  bool active() const noexcept { return !way_.empty(); }
  /// Whether the car drives in reverse, or stops to do so.
  bool reverses() const noexcept { return active() && way_.leg().backward; }
  void cancel() noexcept { way_.clear(); }

  /// Searches a way from `pose` (frame of the path), around which the obstacles are. `nearest` is the point
  /// of the path nearest to it. The way ends at least `ahead` m along the path from there, near the path and
  /// along it. Reversing costs more beyond `sight` (rad from the car's axis), where the laser does not look.
  /// Returns whether there is a way; then it is active.
  bool search(const maps::ClearanceMap& obstacles, const maps::Pose& pose, int nearest, double ahead,
              double sight) noexcept;

  /// The command of the car at `pose`, around which the obstacles are, driving at `speed` (m/s) with wheels
  /// at `steer` (rad), `period` (s) after the last one. None if the way has ended, and is no longer active;
  /// or if an obstacle is on it or the car beside it, and it still is.
  std::optional<Command> follow(const maps::ClearanceMap& obstacles, const maps::Pose& pose, double speed,
                                double steer, double period) noexcept;

 private:
  void find_goals(const maps::Pose& pose, std::size_t nearest, double ahead) noexcept;

  std::vector<maps::ReferencePoint> course_;
  bool closed_;
  BodyOptions body_;
  double wheelbase_;  ///< m
  maps::ManoeuvreSearch search_;
  maps::LegFollower follower_;
  maps::PathCurve way_;  ///< frame of the path
  ReservedVector<maps::ManoeuvreGoal> goals_;
  ReservedVector<maps::Pose> poses_;
};

}  // namespace slalom::vehicle::detail
