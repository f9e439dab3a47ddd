#pragma once

#include <span>
#include <vector>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/moving_obstacles.hpp"

namespace slalom::vehicle::detail {

/// Makes predictions in which cars behind the own car give way to it. The predictor does not know the own
/// car, so the prediction of a faster car behind drives through it. A plan that took this for a collision
/// would brake or swerve, and so cause the collision that it avoids.
///
/// A car is behind if its front axle has not yet passed the rear axle of the own car, so that it would be at
/// fault in a contact. It sees the own car, and with probability 0.9 it brakes with 8 m/s^2 after 0.3 s. A
/// plan that cuts in so late, or brakes so hard, that this does not help collides with it. The hypothesis
/// that it drives on keeps its cost, but its probability is below the limit of the chance constraint.
class CarsBehind {
 public:
  /// Takes the wheelbase of the own car (m).
  explicit CarsBehind(double wheelbase);

  /// Returns the predictions, with new hypotheses for cars behind the own car, whose rear axle is at `own`.
  /// Valid until the next call, and as long as `predicted` is.
  std::span<const maps::PredictedObstacle> giving_way(std::span<const maps::PredictedObstacle> predicted,
                                                      const maps::Pose& own) noexcept;

 private:
  static constexpr std::size_t max_count = 32, max_times = 64;  ///< cars, poses of a hypothesis
  static constexpr std::size_t most = maps::PredictedObstacle::max_hypotheses;
  static constexpr double attention = 0.9;      ///< probability that a car behind gives way
  static constexpr double reaction_time = 0.3;  ///< s, until it brakes
  static constexpr double full_braking = 8;     ///< m/s^2

  bool is_behind(const maps::PredictedObstacle& other, const maps::Pose& own) const noexcept;
  static void give_way(maps::PredictedObstacle& other, std::span<maps::PredictedPose> poses) noexcept;
  static double delayed(double time, double speed) noexcept;

  double wheelbase_;  ///< m
  ReservedVector<maps::PredictedObstacle> predicted_;
  std::vector<maps::PredictedPose> poses_;  ///< [car][hypothesis][time]
};

}  // namespace slalom::vehicle::detail
