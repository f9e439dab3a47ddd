#pragma once

#include <utility>
#include <vector>

#include "navigation/path_guide.hpp"
#include "slalom/navigation/navigator.hpp"

namespace slalom::navigation::detail {

/// Decides on which leg of its path the robot is, and how it gets from one to the next.
class LegChange {
 public:
  LegChange(const NavigatorOptions& options, const Footprint& footprint)
      : options_(options), footprint_(footprint) {}

  /// The path is a new one: the next update places the robot on it.
  void restart() noexcept { fresh_ = true; }
  /// Moves on along the path. `buffer` holds poses meanwhile; paths that do not fit in it are not changed.
  void update(PathGuide& guide, const maps::Pose& robot, const Velocity& velocity, const Costmap& costmap,
              double elapsed, std::vector<maps::Pose>& buffer) noexcept;
  /// Goes on to the next leg before the end of this one.
  void skip(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept;
  /// Whether a leg has begun since the last call.
  bool takes_leg() noexcept { return std::exchange(begun_, false); }
  double turn_left() const noexcept { return turn_left_; }  ///< the rest of a turn, rad; 0 on other legs

 private:
  void place(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
             std::vector<maps::Pose>& buffer) const noexcept;
  void turn_round(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
                  std::vector<maps::Pose>& buffer) const noexcept;
  void face_goal(PathGuide& guide, const Costmap& costmap, std::vector<maps::Pose>& buffer) const noexcept;
  bool is_free(const maps::Pose& robot, double turn, const Costmap& costmap) const noexcept;
  double free_turn(const maps::Pose& robot, double yaw, const Costmap& costmap) const noexcept;
  void begin_leg(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept;
  bool is_finished(const PathGuide& guide, const maps::Pose& robot) const noexcept;

  NavigatorOptions options_;
  Footprint footprint_;
  bool fresh_ = true;
  bool begun_ = false;    ///< whether a leg has begun
  double turn_left_ = 0;  ///< rad
  double last_yaw_ = 0;   ///< rad, of the robot
  double standing_ = 0;   ///< s
};

}  // namespace slalom::navigation::detail
