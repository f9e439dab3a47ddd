#pragma once

#include <array>
#include <span>
#include <vector>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/moving_obstacles.hpp"

namespace slalom::vehicle::detail {

/// Predictions in which cars behind the own one give way to it. A prediction of a car does not know of the
/// own one: that of a faster car behind leads through it, whatever it does. A plan that takes this for a
/// collision brakes or swerves, and so brings about what it avoids.
///
/// A car is behind if its front axle has not yet passed the rear axle of the own car, so that it would be at
/// fault in a contact. It sees the own car, and with probability 0.9 it brakes with 8 m/s^2 after 0.3 s. A
/// plan collides with it if it cuts in so late, or brakes so hard, that this does not help. Else its driving
/// on has the usual cost, but the probability of a collision is below the limit of the chance constraint.
class CarsBehind {
 public:
  /// Takes the wheelbase of the own car (m).
  explicit CarsBehind(double wheelbase);

  /// The predictions, with other hypotheses for cars behind one whose rear axle is at `own`. Valid until the
  /// next call, while `predicted` is.
  std::span<const maps::PredictedObstacle> giving_way(std::span<const maps::PredictedObstacle> predicted,
                                                      const maps::Pose& own) noexcept;

 private:
  static constexpr std::size_t max_count = 32, max_times = 64;  ///< cars, poses of a hypothesis

  bool is_behind(const maps::PredictedObstacle& other, const maps::Pose& own) const noexcept;
  void give_way(maps::PredictedObstacle& other, std::span<maps::PredictedPose> poses) const noexcept;

  double wheelbase_;  ///< m
  ReservedVector<maps::PredictedObstacle> predicted_;
  std::vector<maps::PredictedPose> poses_;  ///< [car][hypothesis][time]
};

}  // namespace slalom::vehicle::detail
