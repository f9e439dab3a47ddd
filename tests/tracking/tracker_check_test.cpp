#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "navigation/grids.hpp"
#include "slalom/tracking/object_tracker.hpp"
#include "slalom/tracking/predictor.hpp"
#include "support/adversary.hpp"
#include "support/allocation_failures.hpp"
#include "support/promise.hpp"
#include "support/repetitions.hpp"

/// Tracker and predictor return finite values, whatever enters them.
namespace slalom::tracking {
namespace {

maps::OccupancyGrid room() {
  maps::OccupancyGrid map = navigation::free_grid(-3, -3, 6, 6);
  navigation::fill(map, -3, -3, 3, -2.8);
  navigation::fill(map, -3, 2.8, 3, 3);
  return map;
}

std::vector<maps::ReferencePoint> course() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 100; ++i) path.push_back({0.1 * i - 5, 0, 0, 3});
  return path;
}

struct Tally {
  long updates = 0, objects = 0, predictions = 0;
  long statuses[5] = {};
};

/// Throws Finding unless all numbers of these objects are finite.
void check(std::span<const TrackedObject> objects) {
  for (const TrackedObject& each : objects) {
    double sum = each.pose.x + each.pose.y + each.pose.yaw + each.speed + each.yaw_rate + each.length +
                 each.width + each.length_deviation + each.width_deviation + each.unseen;
    for (const auto& row : each.covariance)
      for (const double value : row) sum += value;
    testing::require(std::isfinite(sum), "objects are finite");
  }
}

/// The same of predictions, whose weights must sum to 1.
void check(std::span<const maps::PredictedObstacle> predictions) {
  for (const maps::PredictedObstacle& each : predictions) {
    double weights = 0;
    for (int h = 0; h < each.hypotheses; ++h) weights += each.weights[static_cast<std::size_t>(h)];
    testing::require(std::abs(weights - 1) < 1e-6, "the weights sum to 1");
    for (const maps::PredictedPose& at : each.poses)
      testing::require(std::isfinite(at.pose.x + at.pose.y + at.pose.yaw) && at.along_deviation >= 0 &&
                           at.across_deviation >= 0,
                       "predictions are finite");
  }
}

/// A wall 2.5 m to either side with boxes that move through the scan, or any readings.
void draw_scan(testing::Adversary& adversary, std::vector<float>& ranges, int step) {
  ranges.assign(static_cast<std::size_t>(adversary.once_in(20) ? adversary.below(3000) : 181), 2.5F);
  const std::size_t from = static_cast<std::size_t>(step) * 3;
  for (std::size_t i = from; i < std::min(from + 15, ranges.size()); ++i) ranges[i] = 1.2F;
  if (adversary.once_in(5))
    for (float& range : ranges) range = static_cast<float>(adversary.any(-1, 31));
}

/// One tracker, with a map or without, and its predictor. Throws Finding.
void call_tracker(testing::Adversary& adversary, Tally& tally) {
  std::optional<ObjectTracker> tracker;
  if (adversary.below(2)) {
    tracker.emplace(room());
  } else {
    tracker.emplace();
  }
  Predictor predictor = adversary.below(2) ? Predictor(course()) : Predictor();
  std::vector<float> ranges;
  double stamp = 0;
  for (int i = 0; i < 50; ++i) {
    const bool hostile = adversary.once_in(6);
    const auto value = [&](double low, double high) {
      return hostile ? adversary.any(low, high) : adversary.within(low, high);
    };
    draw_scan(adversary, ranges, i);
    stamp += 0.025;
    TrackerInput input;
    input.scan = {ranges, value(-1.6, -1.5), value(0.017, 0.018), 0.05, 30};
    input.sensor = {value(-0.1, 0.1), value(-0.1, 0.1), value(-0.05, 0.05)};
    input.stamp = hostile ? adversary.any(0, 10) : stamp;
    if (adversary.once_in(3)) {
      input.position_deviation = value(0, 0.1);
      input.yaw_deviation = value(0, 0.05);
    }
    const TrackerOutput& out = tracker->update(input);
    check(out.objects);
    testing::require(std::isfinite(out.sensor.x + out.sensor.y + out.sensor.yaw) || hostile,
                     "the pose that was used is finite");
    const auto predicted = predictor.update(out.objects, input.stamp);
    check(predicted);
    ++tally.updates;
    tally.objects += static_cast<long>(out.objects.size());
    tally.predictions += static_cast<long>(predicted.size());
    ++tally.statuses[static_cast<int>(out.status)];
    if (adversary.once_in(40)) tracker->reset();
    if (adversary.once_in(40)) predictor.reset();
  }
}

TEST(TrackerCheck, OutputsAreFiniteForAnyInput) {
  const long calls = testing::repetitions(5000);
  Tally tally;
  for (std::uint64_t seed = testing::first_seed(); tally.updates < calls; ++seed) {
    testing::Adversary adversary(seed);
    try {
      call_tracker(adversary, tally);
    } catch (const testing::Finding& finding) {
      FAIL() << "seed " << seed << ": " << finding.what();
    }
  }
  std::printf("[ calls    ] %ld updates, %ld objects, %ld predictions\n", tally.updates, tally.objects,
              tally.predictions);
  EXPECT_GT(tally.objects, 0);
  EXPECT_GT(tally.predictions, 0);
  for (const TrackerStatus status :
       {TrackerStatus::ok, TrackerStatus::bad_scan, TrackerStatus::bad_pose, TrackerStatus::stale})
    EXPECT_GT(tally.statuses[static_cast<int>(status)], 0) << static_cast<int>(status);
}

/// Objects with numbers that no tracker reports.
TEST(TrackerCheck, PredictionsAreFiniteForAnyObject) {
  const long calls = testing::repetitions(5000);
  Predictor predictors[] = {Predictor(course()), Predictor()};
  for (std::uint64_t seed = 0; static_cast<long>(seed) < calls; ++seed) {
    testing::Adversary adversary(seed);
    TrackedObject objects[3];
    int id = 0;
    for (TrackedObject& each : objects) {
      each.id = ++id;
      each.pose = {adversary.any(-5, 5), adversary.any(-2, 2), adversary.any(-4, 4)};
      each.speed = adversary.any(0, 8);
      each.yaw_rate = adversary.any(-3, 3);
      each.length = adversary.any(0, 2);
      each.width = adversary.any(0, 2);
      for (int i = 0; i < 5; ++i) each.covariance[i][i] = adversary.any(0, 0.1);
    }
    for (Predictor& predictor : predictors) {
      try {
        check(predictor.update(objects, adversary.any(0, 10)));
      } catch (const testing::Finding& finding) {
        FAIL() << "seed " << seed << ": " << finding.what();
      }
    }
  }
}

TEST(AllocationFailure, ATrackerAndAPredictorAreMadeOrThrow) {
  const maps::OccupancyGrid map = room();
  const std::vector<maps::ReferencePoint> path = course();
  EXPECT_GT(testing::fail_every_allocation([&] { return ObjectTracker(map).options().max_objects; }), 5);
  EXPECT_GT(testing::fail_every_allocation([&] { return ObjectTracker().options().max_objects; }), 5);
  EXPECT_GT(testing::fail_every_allocation([&] { return Predictor(path).update({}, 0).size(); }), 3);
}

}  // namespace
}  // namespace slalom::tracking
