#pragma once

#include "navigation/path_guide.hpp"
#include "slalom/maps/manoeuvre_search.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom::navigation::detail {

/// Begins and ends paths: turns and manoeuvres from the pose of the robot onto the path, and from the path
/// into the heading at the goal.
class Approach {
 public:
  static constexpr double longest_change = 3;  ///< m of path that a manoeuvre may replace

  Approach(const NavigatorOptions& options, const Footprint& footprint);

  /// Places the robot on a new path. `buffer` holds poses meanwhile; paths that do not fit in it are not
  /// changed.
  void place(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
             std::vector<maps::Pose>& buffer) noexcept;
  /// The turn (rad) on the spot to a yaw: the shorter one if the body is free on both or on neither. A robot
  /// that turns already (rad/s) goes on if the other way is hardly shorter.
  double turn_to(const maps::Pose& robot, double yaw, const Costmap& costmap, double rate) const noexcept;
  /// Whether there is room for a turn on the spot to a yaw.
  bool has_room_to_turn(const maps::Pose& robot, double yaw, const Costmap& costmap) const noexcept {
    return free_turn(robot, yaw, costmap) != 0;
  }
  /// Goes to a point of the path ahead by a manoeuvre. Returns whether there is one.
  bool join(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
            std::vector<maps::Pose>& buffer) noexcept;
  /// Replaces the end of the path by a manoeuvre into the goal's heading, if there is one.
  void face_goal(PathGuide& guide, const Costmap& costmap, std::vector<maps::Pose>& buffer) noexcept;
  /// Whether the part of the path around the robot is a manoeuvre, which has to be followed exactly.
  bool manoeuvres(const PathGuide& guide) const noexcept {
    return guide.remaining() <= begin_ && guide.remaining() >= end_;
  }

 private:
  double free_turn(const maps::Pose& robot, double yaw, const Costmap& costmap,
                   double rate = 0) const noexcept;
  bool search(const PathGuide& guide, const maps::Pose& from, std::size_t first, std::size_t last,
              bool backward_in_time, const Costmap& costmap) noexcept;

  NavigatorOptions options_;
  Footprint footprint_;
  maps::ManoeuvreSearch search_;
  ReservedVector<maps::ManoeuvreGoal> goals_;
  double begin_ = -1, end_ = 0;  ///< m of path left at the begin and at the end of the last manoeuvre
  std::size_t joint_ = 0;        ///< the point of the path at which the last way that was found meets it
};

}  // namespace slalom::navigation::detail
