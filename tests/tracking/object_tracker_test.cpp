#include "slalom/tracking/object_tracker.hpp"

#include <gtest/gtest.h>

#include <set>

#include "slalom/tracking/predictor.hpp"
#include "support/allocations.hpp"
#include "tracking/scene.hpp"

namespace slalom::tracking {
namespace {

using namespace test;
using testing::on_ring;

constexpr double radius = 5.5;  // m

/// The angle on the ring after a time at a speed.
double driven(double begin, double speed, double time, double at = radius) {
  return begin + speed * time / at;
}

TEST(ObjectTracker, FindsACarAheadWithItsMotion) {
  Scene scene;
  ObjectTracker tracker(scene.map());
  double squares = 0;
  int scans = 0;
  for (int k = 0; k < 240; ++k) {
    const double time = k * Scene::period;
    const maps::Pose sensor = on_ring(driven(0, 3, time));
    const maps::Pose truth = on_ring(driven(0.5, 3.6, time));
    const TrackerOutput& out = tracker.update({scene.scan(sensor, {Scene::car(truth)}), sensor, time});
    ASSERT_EQ(out.status, TrackerStatus::ok);
    if (k < 3) continue;
    ASSERT_EQ(out.objects.size(), 1U) << k;
    const TrackedObject& car = out.objects[0];
    EXPECT_EQ(car.id, 1);
    EXPECT_LT(distance(car.pose, truth), 0.15) << k;
    if (k < 40) continue;
    EXPECT_NEAR(car.speed, 3.6, 0.4) << k;
    EXPECT_NEAR(maps::wrap_angle(car.pose.yaw - truth.yaw), 0, 0.15) << k;
    EXPECT_NEAR(car.yaw_rate, 3.6 / radius, 1.0) << k;
    EXPECT_NEAR(car.length, Scene::length, 0.06) << k;
    EXPECT_NEAR(car.width, Scene::width, 0.06) << k;
    squares += distance(car.pose, truth) * distance(car.pose, truth);
    ++scans;
  }
  EXPECT_LT(std::sqrt(squares / scans), 0.05);
}

TEST(ObjectTracker, ACopyOfTrackerAndPredictorGoesOnWithTheSameBitsAndAllocatesNothing) {
  using State = std::pair<ObjectTracker, Predictor>;
  for (const bool has_map : {true, false}) {
    Scene scene;
    State state{has_map ? ObjectTracker(scene.map()) : ObjectTracker(), Predictor()};
    std::optional<State> copy;
    std::size_t compared = 0;
    for (int k = 0; k < 80; ++k) {
      const double time = k * Scene::period;
      const maps::Pose sensor = on_ring(driven(0, 3, time));
      const maps::LaserScanView scan = scene.scan(sensor, {Scene::car(on_ring(driven(0.5, 3.6, time))),
                                                           Scene::car(on_ring(driven(0.9, 1.5, time), 6.2))});
      if (k == 40) copy = state;
      const long before = testing::allocations();
      ASSERT_GT(before, 0) << "nothing is counted";
      const auto objects = state.first.update({scan, sensor, time, 0.02, 0.01}).objects;
      const auto others = state.second.update(objects, time);
      EXPECT_EQ(testing::allocations(), before);
      if (!copy) continue;
      const auto same_objects = copy->first.update({scan, sensor, time, 0.02, 0.01}).objects;
      const auto same_others = copy->second.update(same_objects, time);
      ASSERT_EQ(objects.size(), same_objects.size());
      ASSERT_EQ(others.size(), same_others.size());
      for (std::size_t i = 0; i < objects.size(); ++i) {
        EXPECT_EQ(objects[i].id, same_objects[i].id);
        EXPECT_EQ(objects[i].pose.x, same_objects[i].pose.x);
        EXPECT_EQ(objects[i].yaw_rate, same_objects[i].yaw_rate);
        EXPECT_EQ(objects[i].covariance[4][4], same_objects[i].covariance[4][4]);
      }
      for (std::size_t i = 0; i < others.size(); ++i) {
        EXPECT_EQ(others[i].weights, same_others[i].weights);
        EXPECT_EQ(others[i].poses.back().pose.x, same_others[i].poses.back().pose.x);
        EXPECT_NE(others[i].poses.data(), same_others[i].poses.data());
        ++compared;
      }
    }
    EXPECT_GT(compared, 40u) << has_map;
    const double end = 80 * Scene::period;
    const TrackerOutput& last = state.first.update({{}, on_ring(driven(0, 3, end)), end});
    EXPECT_EQ(last.status, TrackerStatus::bad_scan);
    EXPECT_FALSE(last.objects.empty());
  }
}

TEST(ObjectTracker, FindsAnOncomingCar) {
  Scene scene;
  ObjectTracker tracker(scene.map());
  int seen = 0;
  for (int k = 0; k < 60; ++k) {
    const double time = k * Scene::period;
    const maps::Pose sensor = on_ring(driven(0, 3, time), 5);
    maps::Pose truth = on_ring(driven(1.2, -4, time, 6.2), 6.2);
    truth.yaw = maps::wrap_angle(truth.yaw + 3.141592653589793);
    const TrackerOutput& out = tracker.update({scene.scan(sensor, {Scene::car(truth)}), sensor, time});
    const TrackedObject* car = nearest(out, truth);
    if (k < 12 || k > 30) continue;
    ASSERT_TRUE(car) << k;
    EXPECT_NEAR(car->speed, 4, 1) << k;
    EXPECT_NEAR(maps::wrap_angle(car->pose.yaw - truth.yaw), 0, 0.3) << k;
    ++seen;
  }
  EXPECT_EQ(seen, 19);
}

TEST(ObjectTracker, TellsCarsSideBySideApart) {
  for (const double gap : {0.05, 0.1, 0.2, 0.4}) {
    SCOPED_TRACE(gap);
    Scene scene;
    ObjectTracker tracker(scene.map());
    const double apart = 0.5 * (gap + Scene::width);
    std::set<int> left, right;
    for (int k = 0; k < 160; ++k) {
      const double time = k * Scene::period;
      const maps::Pose sensor = on_ring(driven(0, 3, time));
      // The cars come together from 1 m.
      const double offset = std::max(apart, 0.66 - 0.3 * time);
      const maps::Pose a = on_ring(driven(0.45, 3, time), radius + offset),
                       b = on_ring(driven(0.45, 3, time), radius - offset);
      const TrackerOutput& out =
          tracker.update({scene.scan(sensor, {Scene::car(a), Scene::car(b)}), sensor, time});
      if (k < 5) continue;
      ASSERT_EQ(out.objects.size(), 2U) << k;
      ASSERT_TRUE(nearest(out, a) && nearest(out, b)) << k;
      left.insert(nearest(out, a)->id);
      right.insert(nearest(out, b)->id);
      EXPECT_LT(distance(nearest(out, a)->pose, a), 0.2) << k;
      EXPECT_LT(distance(nearest(out, b)->pose, b), 0.2) << k;
    }
    EXPECT_EQ(left.size(), 1U);
    EXPECT_EQ(right.size(), 1U);
  }
}

TEST(ObjectTracker, KeepsAnObjectThatAnotherHides) {
  Scene scene;
  ObjectTracker tracker(scene.map());
  int id = 0, hidden = 0;
  for (int k = 0; k < 200; ++k) {
    const double time = k * Scene::period;
    // A car at rest looks across; a slow car near it hides a fast one that passes behind.
    maps::Pose sensor = on_ring(0, 4.3);
    sensor.yaw = 0.6;
    const maps::Pose far = on_ring(driven(-0.1, 2.5, time, 6.5), 6.5), near = on_ring(0.22, 5.2);
    const TrackerOutput& out =
        tracker.update({scene.scan(sensor, {Scene::car(far), Scene::car(near)}), sensor, time});
    const TrackedObject* car = nearest(out, far);
    if (time < 0.25 || time > 2.2) continue;
    ASSERT_TRUE(car) << k;
    if (id == 0) id = car->id;
    EXPECT_EQ(car->id, id) << k;
    hidden += car->unseen > 0;
  }
  EXPECT_GT(hidden, 6) << "nothing hides the car";
}

TEST(ObjectTracker, GivesUpWhatIsGone) {
  Scene scene;
  ObjectTracker tracker(scene.map());
  const maps::Pose sensor = on_ring(0), car = on_ring(0.5);
  double time = 0;
  for (int k = 0; k < 20; ++k, time += Scene::period)
    tracker.update({scene.scan(sensor, {Scene::car(car)}), sensor, time});
  for (int k = 0; k < tracker.options().max_misses; ++k, time += Scene::period)
    EXPECT_EQ(tracker.update({scene.scan(sensor, {}), sensor, time}).objects.size(), 1U);
  EXPECT_TRUE(tracker.update({scene.scan(sensor, {}), sensor, time}).objects.empty());
}

TEST(ObjectTracker, AWrongPoseBeginsNoObject) {
  Scene scene;
  ObjectTracker tracker(scene.map());
  for (int k = 0; k < 20; ++k) {
    const maps::Pose sensor = on_ring(0);
    const maps::Pose wrong{sensor.x - 1.5, sensor.y, sensor.yaw + 0.8};
    const TrackerOutput& out = tracker.update({scene.scan(sensor, {}), wrong, k * Scene::period, 0.03, 0.02});
    EXPECT_EQ(out.status, TrackerStatus::misfit);
    EXPECT_TRUE(out.objects.empty());
  }
}

/// Objects that a tracker reports while a car drives once around a ring without other cars.
std::set<int> objects_of_an_empty_ring(ObjectTracker& tracker, double noise, double dropout,
                                       double position_error, double yaw_error, std::uint64_t seed,
                                       const std::vector<sim::Box>& parked = {}) {
  Scene scene(noise, dropout, seed);
  sim::NormalNoise random;
  random.reset(seed, 7);
  std::vector<float> errors(64);
  std::set<int> ids;
  for (int k = 0; k < 400; ++k) {
    const double time = k * Scene::period;
    const maps::Pose sensor = on_ring(driven(0, 4, time), radius + 0.8 * std::sin(time));
    // The noise is cut at 0, so it is drawn about 1.
    std::fill(errors.begin(), errors.end(), 1.0F);
    random.add(errors, 3, 1.0 / 8, 2, 0);
    const auto error = [&](int i) { return 8 * (errors[i] - 1.0); };
    const maps::Pose believed{sensor.x + position_error * error(0), sensor.y + position_error * error(1),
                              sensor.yaw + yaw_error * error(2)};
    const TrackerOutput& out =
        tracker.update({scene.scan(sensor, parked), believed, time, position_error, yaw_error});
    for (const TrackedObject& each : out.objects) {
      ids.insert(each.id);
    }
  }
  return ids;
}

TEST(ObjectTrackerProperty, FindsNothingInAStaticWorld) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene;
    ObjectTracker exact(scene.map()), localised(scene.map()), mapless;
    EXPECT_TRUE(objects_of_an_empty_ring(exact, 0.02, 0.1, 0, 0, seed).empty());
    EXPECT_TRUE(objects_of_an_empty_ring(localised, 0.02, 0.1, 0.05, 0.02, seed).empty());
    EXPECT_TRUE(objects_of_an_empty_ring(mapless, 0.02, 0.1, 0, 0, seed).empty());
  }
}

TEST(ObjectTrackerProperty, WithoutAMapParkedCarsAreNoObjects) {
  std::vector<sim::Box> parked;
  for (const double angle : {1.0, 2.0, 3.5, 4.4, 5.5})
    parked.push_back(Scene::car(on_ring(angle, 5.5 + 0.3 * std::sin(9 * angle))));
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    ObjectTracker tracker;
    EXPECT_TRUE(objects_of_an_empty_ring(tracker, 0.02, 0.05, 0, 0, seed, parked).empty()) << seed;
  }
}

TEST(ObjectTracker, WithoutAMapFindsWhatMoves) {
  for (const double speed : {-3.0, 1.5, 4.5}) {
    SCOPED_TRACE(speed);
    Scene scene;
    ObjectTracker tracker;
    int found = 0, scans = 0;
    for (int k = 0; k < 120; ++k) {
      const double time = k * Scene::period;
      const maps::Pose sensor = on_ring(driven(0, 3, time), 5);
      maps::Pose truth = on_ring(driven(speed < 0 ? 1.0 : 0.5, speed, time, 6), 6);
      if (speed < 0) truth.yaw = maps::wrap_angle(truth.yaw + 3.141592653589793);
      const double bearing =
          std::abs(maps::wrap_angle(std::atan2(truth.y - sensor.y, truth.x - sensor.x) - sensor.yaw));
      const TrackerOutput& out = tracker.update({scene.scan(sensor, {Scene::car(truth)}), sensor, time});
      for (const TrackedObject& each : out.objects) EXPECT_LT(distance(each.pose, truth), 0.6) << k;
      if (time < 0.5 || bearing > 2.2 || distance(sensor, truth) > 4.5) continue;
      ++scans;
      const TrackedObject* car = nearest(out, truth);
      if (!car) continue;
      ++found;
      EXPECT_NEAR(car->speed, std::abs(speed), 1.2) << k;
    }
    EXPECT_GT(scans, 15);
    EXPECT_GE(found, 0.9 * scans);
  }
}

}  // namespace
}  // namespace slalom::tracking
