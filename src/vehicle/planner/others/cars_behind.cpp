#include "vehicle/planner/others/cars_behind.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/core/math.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr double attention = 0.9;      // probability that a car behind sees the own one and gives way
constexpr double reaction_time = 0.3;  // s, until it brakes
constexpr double full_braking = 8;     // m/s^2
constexpr double along_own_way = 1;    // rad, largest difference of the cars' directions
constexpr double furthest = 1e7;       // m and rad, largest magnitude of a pose

constexpr auto most = static_cast<std::size_t>(maps::PredictedObstacle::max_hypotheses);

/// Takes a car with this speed (m/s) that brakes after its reaction time. Returns when (s) the prediction
/// without braking reaches the place that this car reaches after `time` (s).
double delayed(double time, double speed) noexcept {
  const double braked = std::min(time - reaction_time, speed / full_braking);
  return braked > 0 ? reaction_time + braked * (1 - 0.5 * full_braking * braked / speed) : time;
}

}  // namespace

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

/// Whether the other car drives the same way as a car at `own`, with its front axle behind that car's rear
/// axle.
bool CarsBehind::is_behind(const maps::PredictedObstacle& other, const maps::Pose& own) const noexcept {
  const bool usable = other.hypotheses > 0 && other.hypotheses <= maps::PredictedObstacle::max_hypotheses &&
                      other.interval > 0 && !other.poses.empty() && other.times() <= max_times &&
                      other.poses.size() == other.times() * static_cast<std::size_t>(other.hypotheses);
  if (!usable) return false;
  const maps::Pose& now = other.poses.front().pose;
  const bool near = std::abs(now.x) < furthest && std::abs(now.y) < furthest && std::abs(now.yaw) < furthest;
  if (!near || std::abs(maps::wrap_angle(now.yaw - own.yaw)) > along_own_way) return false;
  return maps::inverse_transform(own, {now.x, now.y}).x < -0.5 * wheelbase_;
}

/// Adds a hypothesis: the car's likeliest one, with braking. If there is no room, it replaces the least
/// likely one.
void CarsBehind::give_way(maps::PredictedObstacle& other,
                          std::span<maps::PredictedPose> poses) const noexcept {
  const maps::PredictedObstacle before = other;
  const std::size_t times = before.times();
  const int likeliest = before.likeliest();
  const maps::Pose from = before.at(likeliest, 0).pose, to = before.at(likeliest, before.interval).pose;
  const double speed = std::hypot(to.x - from.x, to.y - from.y) / before.interval;
  for (std::size_t k = 0; k < times; ++k)
    poses[k] = before.at(likeliest, delayed(static_cast<double>(k) * before.interval, speed));
  const int dropped = before.hypotheses < static_cast<int>(most)
                          ? -1
                          : static_cast<int>(std::min_element(before.weights.begin(), before.weights.end()) -
                                             before.weights.begin());
  other.hypotheses = 1;
  double sum = 0;
  for (int h = 0; h < before.hypotheses; ++h) {
    if (h == dropped) continue;
    const auto own = before.poses.subspan(static_cast<std::size_t>(h) * times, times);
    const auto place = static_cast<std::size_t>(other.hypotheses++);
    std::copy(own.begin(), own.end(), poses.begin() + static_cast<std::ptrdiff_t>(place * times));
    other.weights[place] = before.weights[static_cast<std::size_t>(h)];
    sum += other.weights[place];
  }
  for (int h = 1; h < other.hypotheses; ++h)
    other.weights[static_cast<std::size_t>(h)] *= (1 - attention) / std::max(sum, 1e-9);
  other.weights[0] = other.hypotheses > 1 ? attention : 1;
  other.poses = poses.first(static_cast<std::size_t>(other.hypotheses) * times);
}

}  // namespace slalom::vehicle::detail
