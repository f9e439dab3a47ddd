#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "navigation/grids.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor.hpp"
#include "support/adversary.hpp"
#include "support/promise.hpp"

/// Trackers and predictors as state machines: updates with any scan, and what every object promises.
namespace slalom::tracking {

inline maps::OccupancyGrid room() {
  maps::OccupancyGrid map = navigation::free_grid(-3, -3, 6, 6);
  navigation::fill(map, -3, -3, 3, -2.8);
  navigation::fill(map, -3, 2.8, 3, 3);
  return map;
}

inline std::vector<maps::ReferencePoint> course() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 100; ++i) path.push_back({0.1 * i - 5, 0, 0, 3});
  return path;
}

/// Throws Finding unless all numbers of these objects are finite.
inline void check(std::span<const TrackedObject> objects) {
  for (const TrackedObject& each : objects) {
    double sum = each.pose.x + each.pose.y + each.pose.yaw + each.speed + each.yaw_rate + each.length +
                 each.width + each.unseen;
    for (const auto& row : each.covariance)
      for (const double value : row) sum += value;
    testing::require(std::isfinite(sum), "objects are finite");
  }
}

/// The same of predictions, whose weights must sum to 1.
inline void check(std::span<const maps::PredictedObstacle> predictions) {
  for (const maps::PredictedObstacle& each : predictions) {
    double weights = 0;
    for (int h = 0; h < each.hypotheses; ++h) weights += each.weights[h];
    testing::require(std::abs(weights - 1) < 1e-6, "the weights sum to 1");
    for (const maps::PredictedPose& at : each.poses)
      testing::require(std::isfinite(at.pose.x + at.pose.y + at.pose.yaw) && at.along_deviation >= 0 &&
                           at.across_deviation >= 0,
                       "predictions are finite");
  }
}

/// A wall 2.5 m to either side with boxes that move through the scan, or any readings.
inline void draw_scan(testing::Adversary& adversary, std::vector<float>& ranges, int step) {
  ranges.assign(adversary.once_in(20) ? adversary.below(3000) : 181, 2.5F);
  const std::size_t from = 3 * step;
  for (std::size_t i = from; i < std::min(from + 15, ranges.size()); ++i) ranges[i] = 1.2F;
  if (adversary.once_in(5))
    for (float& range : ranges) range = static_cast<float>(adversary.any(-1, 31));
}

/// One tracker, with a map or without, and its predictor. Returns the number of updates. Throws Finding.
inline int call_tracker(testing::Adversary& adversary) {
  constexpr int updates = 50;
  std::optional<ObjectTracker> tracker;
  if (adversary.below(2)) {
    tracker.emplace(room());
  } else {
    tracker.emplace();
  }
  Predictor predictor = adversary.below(2) ? Predictor(course()) : Predictor();
  std::vector<float> ranges;
  double stamp = 0;
  for (int i = 0; i < updates; ++i) {
    const bool hostile = adversary.once_in(6);
    const auto value = [&](double low, double high) {
      return hostile ? adversary.any(low, high) : adversary.within(low, high);
    };
    draw_scan(adversary, ranges, i);
    stamp += 0.025;
    TrackerInput input;
    input.scan = {ranges, value(-1.6, -1.5), adversary.once_in(20) ? 1e-9 : value(0.017, 0.018), 0.05, 30};
    input.sensor = {value(-0.1, 0.1), value(-0.1, 0.1), value(-0.05, 0.05)};
    input.stamp = hostile ? adversary.any(0, 10) : stamp;
    if (adversary.once_in(3)) {
      input.position_deviation = value(0, 0.1);
      input.yaw_deviation = value(0, 0.05);
    }
    const testing::CallLimits limits;
    const TrackerOutput& out = tracker->update(input);
    check(out.objects);
    testing::require(std::isfinite(out.sensor.x + out.sensor.y + out.sensor.yaw) || hostile,
                     "the pose that was used is finite");
    const auto predicted = predictor.update(out.objects, input.stamp);
    limits.check();
    check(predicted);
    TrackedObject odd;  // such as no tracker reports
    odd.pose = {adversary.any(-5, 5), adversary.any(-2, 2), adversary.any(-4, 4)};
    odd.speed = adversary.any(0, 8);
    odd.yaw_rate = adversary.any(-3, 3);
    odd.length = odd.width = adversary.any(0, 2);
    for (int k = 0; k < 5; ++k) odd.covariance[k][k] = adversary.any(0, 0.1);
    if (adversary.once_in(4)) check(predictor.update({&odd, 1}, adversary.any(0, 10)));
    if (adversary.once_in(40)) tracker->reset();
    if (adversary.once_in(40)) predictor.reset();
  }
  return updates;
}

}  // namespace slalom::tracking
