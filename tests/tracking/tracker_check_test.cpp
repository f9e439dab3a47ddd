#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "support/adversarial_tries.hpp"
#include "support/allocation_failures.hpp"
#include "support/repetitions.hpp"
#include "tracking/tracker_calls.hpp"

/// Tracker and predictor return finite values, whatever enters them.
namespace slalom::tracking {
namespace {

TEST(TrackerCheck, BeamsThatAreNearlyOneEnd) {
  // An object spans 1e8 such beams; the test would not end if each were looked at.
  ObjectTracker tracker(room());
  std::vector<float> ranges;
  double stamp = 0;
  const auto objects = [&](double increment) {
    return tracker
        .update({.scan = {ranges, -1.5, increment, 0.05, 30}, .sensor = {}, .stamp = stamp += 0.025})
        .objects.size();
  };
  for (int i = 0; i < 200; ++i) {
    for (int k = 0; k < 8; ++k) {
      ranges.assign(181, 30.0F);
      std::fill_n(ranges.begin() + 80, 15, 1.2F);
      objects(0.0175);
    }
    EXPECT_GT(objects(0.0175), 0u);
    objects(1e-9);
  }
}

TEST(TrackerCheck, OutputsAreFiniteForAnyInput) {
  TrackerTally tally;
  testing::try_adversaries(
      testing::repetitions(5000), tally.updates,
      [&](testing::Adversary& adversary, std::uint64_t) { call_tracker(adversary, tally); });
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
  Predictor predictors[] = {Predictor(course()), Predictor()};
  long made = 0;
  testing::try_adversaries(testing::repetitions(5000), made, [&](testing::Adversary& adversary, auto) {
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
    for (Predictor& predictor : predictors) check(predictor.update(objects, adversary.any(0, 10)));
    ++made;
  });
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
