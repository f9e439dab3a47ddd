#pragma once

#include <algorithm>
#include <cmath>
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
  explicit CarsBehind(double wheelbase) : wheelbase_(wheelbase), poses_(max_count * most * max_times) {
    predicted_.reserve(max_count);
  }

  /// Returns the predictions, with new hypotheses for cars behind the own car, whose rear axle is at `own`.
  /// Valid until the next call, and as long as `predicted` is.
  std::span<const maps::PredictedObstacle> giving_way(std::span<const maps::PredictedObstacle> predicted,
                                                      const maps::Pose& own) noexcept {
    const auto behind = [&](const maps::PredictedObstacle& other) { return is_behind(other, own); };
    if (predicted.size() > max_count || std::none_of(predicted.begin(), predicted.end(), behind))
      return predicted;
    predicted_.assign(predicted.begin(), predicted.end());
    for (std::size_t i = 0; i < predicted_.size(); ++i) {
      if (!behind(predicted[i])) continue;
      const std::size_t size = predicted[i].times();
      give_way(predicted_[i], std::span(poses_).subspan(i * most * max_times, most * size));
    }
    return predicted_;
  }

 private:
  static constexpr std::size_t max_count = 32, max_times = 64;  ///< cars, poses of a hypothesis
  static constexpr std::size_t most = maps::PredictedObstacle::max_hypotheses;
  static constexpr double attention = 0.9;      ///< probability that a car behind gives way
  static constexpr double reaction_time = 0.3;  ///< s, until it brakes
  static constexpr double full_braking = 8;     ///< m/s^2
  static constexpr double along_own_way = 1;    ///< rad, largest difference of the cars' directions
  static constexpr double furthest = 1e7;       ///< m and rad, largest magnitude of a pose

  /// Whether the other car drives the same way as one at `own`, its front axle behind that one's rear axle.
  bool is_behind(const maps::PredictedObstacle& other, const maps::Pose& own) const noexcept {
    const bool usable = other.hypotheses > 0 && other.hypotheses <= static_cast<int>(most) &&
                        other.interval > 0 && !other.poses.empty() && other.times() <= max_times &&
                        other.poses.size() == other.times() * static_cast<std::size_t>(other.hypotheses);
    if (!usable) return false;
    const maps::Pose& now = other.poses.front().pose;
    const bool near =
        std::abs(now.x) < furthest && std::abs(now.y) < furthest && std::abs(now.yaw) < furthest;
    if (!near || std::abs(maps::wrap_angle(now.yaw - own.yaw)) > along_own_way) return false;
    return maps::inverse_transform(own, {now.x, now.y}).x < -0.5 * wheelbase_;
  }

  /// Adds a hypothesis: the car's likeliest one, with braking. If there is no room, it replaces the least
  /// likely one. `poses` has room for all hypotheses.
  static void give_way(maps::PredictedObstacle& other, std::span<maps::PredictedPose> poses) noexcept {
    const maps::PredictedObstacle before = other;
    const std::size_t times = before.times();

    // The new hypothesis comes first.
    const int likeliest = before.likeliest();
    const maps::Pose from = before.at(likeliest, 0).pose, to = before.at(likeliest, before.interval).pose;
    const double speed = std::hypot(to.x - from.x, to.y - from.y) / before.interval;
    for (std::size_t k = 0; k < times; ++k)
      poses[k] = before.at(likeliest, delayed(static_cast<double>(k) * before.interval, speed));
    std::size_t kept = 1;

    // The others follow, without the least likely one of a full set.
    const auto least = std::min_element(before.weights.begin(), before.weights.end());
    const bool full = before.hypotheses == static_cast<int>(most);
    double sum = 0;
    for (std::size_t h = 0; h < static_cast<std::size_t>(before.hypotheses); ++h) {
      if (full && before.weights.begin() + static_cast<std::ptrdiff_t>(h) == least) continue;
      const auto own = before.poses.subspan(h * times, times);
      std::copy(own.begin(), own.end(), poses.subspan(kept * times).begin());
      sum += other.weights[kept++] = before.weights[h];
    }

    // The new hypothesis has the probability of attention, the others share the rest.
    for (std::size_t h = 1; h < kept; ++h) other.weights[h] *= (1 - attention) / std::max(sum, 1e-9);
    other.weights[0] = kept > 1 ? attention : 1;
    other.hypotheses = static_cast<int>(kept);
    other.poses = poses.first(kept * times);
  }

  /// Takes a car with this speed (m/s) that brakes after its reaction time. Returns when (s) the prediction
  /// without braking reaches the place that this car reaches after `time` (s).
  static double delayed(double time, double speed) noexcept {
    const double braked = std::min(time - reaction_time, speed / full_braking);
    return braked > 0 ? reaction_time + braked * (1 - 0.5 * full_braking * braked / speed) : time;
  }

  double wheelbase_;  ///< m
  ReservedVector<maps::PredictedObstacle> predicted_;
  std::vector<maps::PredictedPose> poses_;  ///< [car][hypothesis][time]
};

}  // namespace slalom::vehicle::detail
