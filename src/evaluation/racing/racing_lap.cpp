#include "slalom/evaluation/racing_lap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slalom::evaluation {
namespace {

constexpr double rounding = 1e-9;  // excess that a profile at the limit may have

/// The smallest of the values (first, sorted) such that those up to it have at least `share` of the weight
/// (second).
double weighted_percentile(const std::vector<std::pair<double, double>>& weighted, double total,
                           double share) {
  double sum = 0;
  for (const auto& [value, weight] : weighted) {
    sum += weight;
    if (sum >= share * total) return value;
  }
  return weighted.back().first;
}

}  // namespace

std::string_view name(RacingEnd end) noexcept {
  return end == RacingEnd::completed ? "completed" : end == RacingEnd::collision ? "collision" : "timeout";
}

std::optional<RacingSample> at_distance(std::span<const RacingSample> samples, double distance) {
  const auto after = std::find_if(samples.begin(), samples.end(),
                                  [&](const RacingSample& s) { return s.distance >= distance; });
  if (after == samples.end()) return std::nullopt;
  if (after == samples.begin()) return *after;
  const RacingSample& before = *std::prev(after);
  const double share = (distance - before.distance) / (after->distance - before.distance);
  RacingSample at = *after;
  at.distance = distance;
  at.time = before.time + share * (after->time - before.time);
  at.speed = before.speed + share * (after->speed - before.speed);
  return at;
}

double time_behind(std::span<const RacingSample> lap, std::span<const RacingSample> other, double distance) {
  const auto time = [&](std::span<const RacingSample> samples) {
    return at_distance(samples, distance).value_or(samples.back()).time;
  };
  return time(lap) - time(other);
}

std::array<double, racing_sectors> sector_times(std::span<const RacingSample> samples, double length) {
  std::array<double, racing_sectors> times;
  times.fill(std::numeric_limits<double>::quiet_NaN());
  double begin = 0;
  for (int i = 0; i < racing_sectors; ++i) {
    // The last sector ends with the lap, whatever the rounding of its length.
    const auto end = i + 1 < racing_sectors ? at_distance(samples, length * (i + 1) / racing_sectors)
                     : samples.back().distance >= length * (1 - 1e-9) ? std::optional(samples.back())
                                                                      : std::nullopt;
    if (!end) break;
    times[static_cast<std::size_t>(i)] = end->time - begin;
    begin = end->time;
  }
  return times;
}

GripUse grip_use(std::span<const RacingSample> samples, double limit) {
  std::vector<std::pair<double, double>> weighted;  // acceleration and duration
  double total = 0, beyond = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double duration = samples[i].time - samples[i - 1].time;
    if (!(duration > 0)) continue;  // the first sample of the next lap
    const double acceleration = std::hypot(samples[i].longitudinal, samples[i].lateral);
    weighted.emplace_back(acceleration, duration);
    total += duration;
    if (acceleration > limit * (1 + rounding)) beyond += duration;
  }
  if (weighted.empty()) return {};
  std::sort(weighted.begin(), weighted.end());
  return {weighted_percentile(weighted, total, 0.5), weighted_percentile(weighted, total, 0.99),
          beyond / total};
}

}  // namespace slalom::evaluation
