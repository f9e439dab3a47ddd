#include "vehicle/planner/obstacles/cars_behind.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/maps/pose_limits.hpp"
#include "vehicle/planner/car_scale.hpp"

namespace slalom::vehicle::detail {
CarsBehind::CarsBehind(double wheelbase) : wheelbase_(wheelbase), poses_(max_count * most * max_times) {
  predicted_.reserve(max_count);
}

std::span<const maps::PredictedObstacle> CarsBehind::giving_way(
    std::span<const maps::PredictedObstacle> predicted, const maps::Pose& own) noexcept {
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

/// Whether the other car drives the same way as one at `own`, its front axle behind that one's rear axle.
bool CarsBehind::is_behind(const maps::PredictedObstacle& other, const maps::Pose& own) const noexcept {
  const bool usable = other.hypotheses > 0 && other.hypotheses <= static_cast<int>(most) &&
                      other.interval > 0 && !other.poses.empty() && other.times() <= max_times &&
                      other.poses.size() == other.times() * static_cast<std::size_t>(other.hypotheses);
  if (!usable) return false;
  const maps::Pose& now = other.poses.front().pose;
  if (!maps::is_plausible(now) || std::abs(maps::wrap_angle(now.yaw - own.yaw)) > CarScale::same_way)
    return false;
  return maps::inverse_transform(own, {now.x, now.y}).x < -0.5 * wheelbase_;
}

/// Takes a car with this speed (m/s) that brakes after its reaction time. Returns when (s) the prediction
/// without braking reaches the place that this car reaches after `time` (s).
double CarsBehind::delayed(double time, double speed) noexcept {
  const double braked = std::min(time - reaction_time, speed / full_braking);
  return braked > 0 ? reaction_time + braked * (1 - 0.5 * full_braking * braked / speed) : time;
}

/// Adds a hypothesis: the car's likeliest one, with braking. If there is no room, it replaces the least
/// likely one. `poses` has room for all hypotheses.
void CarsBehind::give_way(maps::PredictedObstacle& other, std::span<maps::PredictedPose> poses) noexcept {
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

}  // namespace slalom::vehicle::detail
