#pragma once

#include <optional>

#include "slalom/maps/moving_obstacles.hpp"
#include "slalom/navigation/footprint.hpp"
#include "slalom/navigation/navigator.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor.hpp"

namespace slalom::navigation::detail {

/// The moving obstacles around the robot, over the steps of a plan.
class Others {
 public:
  /// For plans of so many steps, and costmaps with this resolution (m).
  Others(const Footprint& footprint, const NavigatorOptions& options, std::size_t steps, double resolution);

  /// Takes predictions in the map frame, which must live until the next update, or predicts what the costmaps
  /// show.
  void update(std::span<const maps::PredictedObstacle> predicted, const maps::Pose& robot,
              const Costmap& costmap, double elapsed) noexcept;
  void clear() noexcept;

  /// The obstacles as rollouts see them, map frame.
  maps::MovingObstaclesView view() const noexcept { return obstacles_.view(); }
  /// Whether one of them is so near that the robot may have to wait for it.
  bool are_near(const maps::Point& robot) const noexcept;
  /// Finds the place where a robot on a path, with points `step` (m) apart, meets an object that comes
  /// towards it or goes ahead of it, and the room to pass there. Those that cross it are left to the plans.
  std::optional<maps::ClosedDisc> meeting(std::span<const maps::Pose> path, double step) const noexcept;
  /// Whether the plan, up to the pose with this index, comes into the margins of an object or collides with
  /// one. A robot that is within the margins already may leave them, and one that collides may move away, but
  /// a robot within the margins must not collide, nor come nearer to where the object is now.
  bool meet(std::span<const maps::Pose> plan, std::size_t last) const noexcept;

 private:
  std::span<const maps::PredictedObstacle> find(const maps::Pose& robot, const Costmap& costmap) noexcept;
  bool comes_close(std::span<const maps::Pose> plan, std::size_t last) const noexcept;

  double time_step_;                  ///< s
  double speed_;                      ///< m/s, at which the robot follows paths
  double half_width_;                 ///< m, of the robot, with the margin
  maps::MovingObstacleOptions body_;  ///< the robot's, with margins
  maps::MovingObstacles obstacles_;   ///< obstacles with margins and deviations
  maps::MovingObstacles bodies_;      ///< obstacles without them
  tracking::ObjectTracker tracker_;
  tracking::Predictor predictor_;
  std::array<float, 360> ranges_{};  ///< m, of a scan of the costmap
  double range_;                     ///< m, largest of them
  double now_ = 0;                   ///< s
};

}  // namespace slalom::navigation::detail
