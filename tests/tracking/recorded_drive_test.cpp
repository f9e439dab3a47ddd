// Sums over a drive among cars and people, as they were recorded: they tell when a number of tracker or
// predictor changes.
#include <gtest/gtest.h>

#include <iomanip>

#include "slalom/tracking/people.hpp"
#include "slalom/tracking/predictor.hpp"
#include "tracking/scene.hpp"

namespace slalom::tracking {
namespace {

using namespace test;
using testing::on_ring;

constexpr double middle = 5.5;  // m

std::vector<maps::ReferencePoint> ring_course() {
  std::vector<maps::ReferencePoint> course;
  for (int i = 0; i < 200; ++i) {
    const maps::Pose at = on_ring(2 * 3.141592653589793 * i / 200, middle);
    course.push_back({at.x, at.y, at.yaw, 3 + std::sin(0.1 * i)});
  }
  return course;
}

/// What is tracked at a time (s): a car that starts, one that overtakes it, an oncoming one, one that
/// reverses out of a gap, and one that stands.
std::vector<sim::Box> traffic(double time, double length, double width) {
  const double started = std::max(time - 1, 0.0);
  const auto at = [&](double arc, double from_middle) { return on_ring(arc / middle, from_middle); };
  maps::Pose oncoming = at(22 - 3.5 * time, 6.4), backwards = at(9 - 0.9 * std::max(time - 2, 0.0), 4.7);
  oncoming.yaw += 3.141592653589793;
  const maps::Pose poses[] = {at(3 + 1.2 * started * started, 5.7),
                              at(1.2 + 3.4 * time, 5.2 + 0.5 * std::sin(2 * time)), oncoming, backwards,
                              at(14, 4.9)};
  std::vector<sim::Box> boxes;
  for (const maps::Pose& pose : poses) boxes.push_back({pose, length, width});
  return boxes;
}

struct Sums {
  double objects = 0, place = 0, speed = 0, turn = 0, size = 0, deviation = 0;
  double predicted = 0, weights = 0, ways = 0;
};

Sums drive(ObjectTracker tracker, Predictor predictor, double length, double width, double error) {
  Scene scene;
  Sums sums;
  for (int k = 0; k < 280; ++k) {
    const double time = k * Scene::period;
    const maps::Pose sensor = on_ring(2.2 * time / middle, middle + 0.4 * std::sin(time));
    const maps::Pose believed{sensor.x + error * std::sin(7 * time), sensor.y,
                              sensor.yaw + 0.3 * error * std::cos(5 * time)};
    const auto scan = scene.scan(sensor, traffic(time, length, width));
    const auto objects = tracker.update({scan, believed, time, error, 0.3 * error}).objects;
    for (const TrackedObject& each : objects) {
      ++sums.objects;
      sums.place += each.pose.x + 2 * each.pose.y + each.pose.yaw;
      sums.speed += each.speed;
      sums.turn += each.yaw_rate;
      sums.size += each.length + 2 * each.width;
      for (int i = 0; i < 5; ++i) sums.deviation += (i + 1) * std::sqrt(each.covariance[i][i]);
    }
    for (const maps::PredictedObstacle& each : predictor.update(objects, time)) {
      ++sums.predicted;
      for (int h = 0; h < each.hypotheses; ++h) {
        const maps::PredictedPose& last = each.at(h, 1.0);
        sums.weights += (h + 1) * each.weights[h];
        sums.ways += last.pose.x + 2 * last.pose.y + last.along_deviation + last.across_deviation;
      }
    }
  }
  return sums;
}

void expect_sums(const Sums& found, const Sums& recorded) {
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6 * (1 + std::abs(b)); };
  EXPECT_TRUE(found.objects == recorded.objects && near(found.place, recorded.place) &&
              near(found.speed, recorded.speed) && near(found.turn, recorded.turn) &&
              near(found.size, recorded.size) && near(found.deviation, recorded.deviation) &&
              found.predicted == recorded.predicted && near(found.weights, recorded.weights) &&
              near(found.ways, recorded.ways))
      << std::setprecision(9) << found.objects << ", " << found.place << ", " << found.speed << ", "
      << found.turn << ", " << found.size << ", " << found.deviation << ", " << found.predicted << ", "
      << found.weights << ", " << found.ways;
}

TEST(RecordedDrive, AmongCarsOnAMap) {
  expect_sums(
      drive(ObjectTracker(Scene().map()), Predictor(ring_course()), Scene::length, Scene::width, 0.03),
      {844, 29300.8363, 1626.1274, 182.675409, 976.506748, 6598.5358, 389, 545.324945, 42366.9963});
}

TEST(RecordedDrive, AmongCarsWithoutAMap) {
  expect_sums(drive(ObjectTracker(), Predictor(ring_course()), Scene::length, Scene::width, 0),
              {312, 11412.4367, 1397.35645, 171.032596, 364.452449, 1843.73363, 303, 447.21211, 34379.5535});
}

TEST(RecordedDrive, AmongPeople) {
  expect_sums(
      drive(ObjectTracker(people_tracker_options()), Predictor(people_predictor_options()), 0.5, 0.5, 0),
      {314, 12577.5553, 1074.2729, 0, 471, 3406.19132, 307, 340.042301, 25211.268});
}

}  // namespace
}  // namespace slalom::tracking
