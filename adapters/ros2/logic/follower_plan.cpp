#include "logic/follower_plan.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "slalom/navigation/footprint.hpp"

namespace slalom::nodes {
namespace {

using maps::Point;

constexpr double same_path = 0.05;   ///< m between two plans that lead along each other
constexpr double same_goal = 0.001;  ///< m and rad
constexpr double notable = 0.02;     ///< m by which a point of the plan moves
constexpr double search_ahead = 3;   ///< m of the plan in which the pose nearest to the robot is searched

Point point_of(const maps::Pose& pose) {
  return {pose.x, pose.y};
}

}  // namespace

void FollowerPlan::use(const std::vector<maps::Pose>& plan, const std::string& frame) {
  if (plan.empty()) throw std::invalid_argument("path: no poses, must have at least one");
  for (std::size_t i = 0; i < plan.size(); ++i)
    if (!(std::isfinite(plan[i].x) && std::isfinite(plan[i].y) && std::isfinite(plan[i].yaw)))
      throw std::invalid_argument("path: pose " + std::to_string(i) + " must be finite");
  if (frame == frame_ && leads_along(plan)) return;
  poses_ = plan;
  frame_ = frame;
  nearest_ = 0;
  forget_placement();
}

/// Whether each pose lies on the present plan, in the same order, and both have the same goal.
bool FollowerPlan::leads_along(const std::vector<maps::Pose>& plan) const {
  if (poses_.size() < 2) return false;
  const maps::Pose &goal = poses_.back(), &other = plan.back();
  if (maps::distance(point_of(goal), point_of(other)) > same_goal ||
      std::abs(maps::wrap_angle(goal.yaw - other.yaw)) > same_goal)
    return false;
  std::size_t segment = 0;
  for (const maps::Pose& pose : plan) {
    const auto is_on = [&](std::size_t i) {
      return navigation::distance_to_segment(point_of(pose), point_of(poses_[i]), point_of(poses_[i + 1])) <=
             same_path;
    };
    while (segment + 1 < poses_.size() && !is_on(segment)) ++segment;
    if (segment + 1 >= poses_.size()) return false;
  }
  return true;
}

/// Whether a transform moves the plan from its present placement. The points furthest apart decide: the one
/// nearest to the robot, and the goal.
bool FollowerPlan::has_moved(const maps::Pose& plan_frame) const {
  const auto moves = [&](const maps::Pose& pose) {
    const Point now = maps::transform(plan_frame, point_of(pose));
    const Point then = maps::transform(placed_frame_, point_of(pose));
    return maps::distance(now, then) > notable;
  };
  return moves(poses_[nearest_]) || moves(poses_.back());
}

/// Moves on to the pose nearest to the robot. Paths may cross themselves, so it searches only a part ahead.
void FollowerPlan::advance(const Point& robot) {
  double least = std::numeric_limits<double>::infinity(), length = 0;
  std::size_t best = nearest_;
  for (std::size_t i = nearest_; i < poses_.size() && length <= search_ahead; ++i) {
    const double away = maps::distance(robot, point_of(poses_[i]));
    if (away < least) {
      least = away;
      best = i;
    }
    if (i + 1 < poses_.size()) length += maps::distance(point_of(poses_[i]), point_of(poses_[i + 1]));
  }
  nearest_ = best;
}

const std::vector<maps::Pose>* FollowerPlan::place(const maps::Pose& plan_frame, const maps::Pose& robot) {
  advance(maps::inverse_transform(plan_frame, point_of(robot)));
  if (is_placed_ && !has_moved(plan_frame)) return nullptr;
  placed_.clear();
  for (std::size_t i = nearest_; i < poses_.size(); ++i) {
    const Point at = maps::transform(plan_frame, point_of(poses_[i]));
    placed_.push_back({at.x, at.y, poses_[i].yaw + plan_frame.yaw});
  }
  placed_frame_ = plan_frame;
  is_placed_ = true;
  return &placed_;
}

}  // namespace slalom::nodes
