#pragma once

#include <string>
#include <vector>

#include "slalom/maps/pose.hpp"

namespace slalom::nodes {

/// A plan in a frame that moves against that of the costmap, as `map` moves against `odom` when the
/// localisation corrects itself.
class FollowerPlan {
 public:
  /// Takes a plan, unless it leads along the present one to the same goal: a planner that plans again every
  /// second does that. Throws std::invalid_argument, naming the pose, unless there is at least one pose, and
  /// all are finite; then the present one stays.
  void use(const std::vector<maps::Pose>& plan, const std::string& frame);
  /// Whether there is no plan.
  bool empty() const { return poses_.empty(); }
  /// Forgets the plan.
  void clear() {
    poses_.clear();
    forget_placement();
  }
  /// The next `place` returns the plan.
  void forget_placement() { is_placed_ = false; }

  /// The part of the plan ahead of the robot, in the frame of the costmap, in which both poses are given.
  /// Null if it was returned before and its frame has hardly moved since. Valid until the next call.
  const std::vector<maps::Pose>* place(const maps::Pose& plan_frame, const maps::Pose& robot);

 private:
  bool leads_along(const std::vector<maps::Pose>& plan) const;
  bool has_moved(const maps::Pose& plan_frame) const;
  void advance(const maps::Point& robot);

  std::vector<maps::Pose> poses_;
  std::string frame_;
  std::size_t nearest_ = 0;  ///< index of the pose nearest to the robot
  bool is_placed_ = false;
  maps::Pose placed_frame_;
  std::vector<maps::Pose> placed_;
};

}  // namespace slalom::nodes
