#pragma once

#include <vector>

#include "navigation/path_guide.hpp"
#include "slalom/maps/manoeuvre_search.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom::navigation::detail {

/// Begins and ends paths: turns and manoeuvres from the pose of the robot onto the path, and from the path
/// into the heading at the goal.
class Approach {
 public:
  Approach(const NavigatorOptions& options, const Footprint& footprint);

  /// Places the robot on a new path. `buffer` holds poses meanwhile; paths that do not fit in it are not
  /// changed.
  void place(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
             std::vector<maps::Pose>& buffer) noexcept;
  /// The turn (rad) on the spot to a yaw: the shorter one if the body is free on both or on neither.
  double turn_to(const maps::Pose& robot, double yaw, const Costmap& costmap) const noexcept;

 private:
  double free_turn(const maps::Pose& robot, double yaw, const Costmap& costmap) const noexcept;
  void join(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
            std::vector<maps::Pose>& buffer) noexcept;
  void face_goal(PathGuide& guide, const Costmap& costmap, std::vector<maps::Pose>& buffer) noexcept;
  bool search(const PathGuide& guide, const maps::Pose& from, std::size_t first, std::size_t last,
              bool backward_in_time, const Costmap& costmap) noexcept;

  NavigatorOptions options_;
  Footprint footprint_;
  maps::ManoeuvreSearch search_;
  ReservedVector<maps::ManoeuvreGoal> goals_;
  std::size_t joint_ = 0;  ///< the point of the path at which the last way that was found meets it
};

}  // namespace slalom::navigation::detail
