#include "slalom/tracking/predictor.hpp"

#include <functional>

#include "support/allocations.hpp"
#include "support/thrown_words.hpp"
#include "tracking/course_line.hpp"
#include "tracking/manoeuvres.hpp"

namespace slalom::tracking::predictor_test {
namespace {

constexpr double pi = 3.141592653589793, radius = 6, period = 0.025;

/// A circle round the origin, counter-clockwise, at 4 m/s.
std::vector<maps::ReferencePoint> circle() {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 300; ++i) {
    const double angle = 2 * pi * i / 300;
    path.push_back({radius * std::cos(angle), radius * std::sin(angle), angle + pi / 2, 4});
  }
  return path;
}

/// A car `offset` m to the left of the circle.
maps::Pose beside(double arc, double offset, double turned = 0) {
  const double angle = arc / radius;
  return {(radius - offset) * std::cos(angle), (radius - offset) * std::sin(angle), angle + pi / 2 + turned};
}

TrackedObject object_at(const maps::Pose& pose, double speed, double yaw_rate = 0) {
  TrackedObject object{
      .id = 3, .pose = pose, .speed = speed, .yaw_rate = yaw_rate, .length = 0.58, .width = 0.31};
  const double deviations[5] = {0.03, 0.03, 0.05, 0.2, 0.3};
  for (int i = 0; i < 5; ++i) object.covariance[i][i] = deviations[i] * deviations[i];
  return object;
}

double apart(const maps::Pose& a, const maps::Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// The weight of the hypotheses that are within `reach` (m) of a pose at a time.
double weight_near(const maps::PredictedObstacle& predicted, const maps::Pose& pose, double time,
                   double reach) {
  double sum = 0;
  for (int h = 0; h < predicted.hypotheses; ++h)
    if (apart(predicted.at(h, time).pose, pose) < reach) sum += predicted.weights[h];
  return sum;
}

/// Shows a predictor an object in the periods [first, last]; the object at a time. The last prediction.
maps::PredictedObstacle shown(Predictor& predictor, int first, int last,
                              const std::function<TrackedObject(double)>& object) {
  maps::PredictedObstacle predicted;
  for (int i = first; i <= last; ++i) {
    const TrackedObject now = object(period * i);
    predicted = predictor.update({&now, 1}, period * i)[0];
  }
  return predicted;
}

/// The same for 2 s.
maps::PredictedObstacle after_two_seconds(Predictor& predictor,
                                          const std::function<TrackedObject(double)>& object) {
  return shown(predictor, 0, 80, object);
}

TEST(CourseLine, ProjectsWhatItPlaces) {
  const CourseLine course(circle());
  for (const double arc : {0.0, 3.3, 20.0, 37.6}) {
    for (const double offset : {-1.0, 0.0, 0.7}) {
      const maps::Pose pose = beside(arc, offset);
      const CourseLine::Place place = course.project({pose.x, pose.y});
      EXPECT_NEAR(course.between(arc, place.arc), 0, 0.02) << arc << " " << offset;
      EXPECT_NEAR(place.offset, offset, 0.01);
      EXPECT_NEAR(maps::wrap_angle(course.at(arc).yaw - pose.yaw), 0, 0.01);
      EXPECT_NEAR(course.at(arc).curvature, 1 / radius, 0.005);
    }
  }
  EXPECT_NEAR(course.between(37, 0.5), 0.5 + 2 * pi * radius - 37, 0.02);
}

TEST(CourseLine, EndsOfAnOpenCourse) {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 50; ++i) path.push_back({0.2 * i, 0, 0, 1});
  const CourseLine course(path);
  EXPECT_DOUBLE_EQ(course.project({12, 1}).arc, 9.8);
  EXPECT_NEAR(course.at(100).x, 9.8, 1e-9);
  EXPECT_NEAR(course.at(-1).x, 0, 1e-9);
}

TEST(Predictor, ACarThatKeepsItsOffsetIsExpectedToKeepIt) {
  Predictor predictor(circle());
  const auto predicted = after_two_seconds(
      predictor, [](double time) { return object_at(beside(3 * time * radius / (radius - 0.6), 0.6), 3); });
  const double at = 3 * 3 * radius / (radius - 0.6);
  EXPECT_GT(weight_near(predicted, beside(at, 0.6), 1, 0.15), 0.7);
  EXPECT_EQ(predicted.id, 3);
  EXPECT_EQ(predicted.hypotheses, 4);
}

TEST(Predictor, ACarThatReturnsToTheCourseIsExpectedToFollowIt) {
  PredictorOptions options;
  const CourseLine course(circle());
  Motion motion;
  motion.on_course = true;
  motion.speed = 3;
  motion.offset = 1.2;
  const Habits habits(course);
  Way way(motion, Manoeuvre::follow, course, habits, options);
  Predictor predictor(circle(), options);
  double driven = 0;
  const auto predicted = shown(predictor, 0, 24, [&](double time) {  // 0.6 s
    way.advance(time - driven);
    driven = time;
    return object_at(way.pose(), std::hypot(way.now().speed, way.now().drift));
  });
  way.advance(1);
  EXPECT_GT(weight_near(predicted, way.pose(), 1, 0.2), 0.7);
}

TEST(Predictor, ACarThatComesRoundAgainIsExpectedToDriveAsBefore) {
  Predictor predictor(circle());
  // A line of its own, three times to the left and to the right in a lap, and slower on the left.
  std::vector<TrackedObject> seen;
  double arc = 0;
  const auto offset = [](double at) { return 0.6 * std::sin(3 * at / radius); };
  while (arc < 3 * 2 * pi * radius) {
    const double speed = 3 - 0.8 * std::sin(3 * arc / radius);
    const double turned = std::atan(1.8 / radius * std::cos(3 * arc / radius));
    seen.push_back(object_at(beside(arc, offset(arc), turned), speed));
    arc += speed * std::cos(turned) * period * radius / (radius - offset(arc));
  }
  constexpr std::size_t ahead = 48;  // periods: 1.2 s
  const std::size_t lap = seen.size() / 3;
  std::array<double, 3> error{};  // m, mean over the hypotheses and a lap
  for (std::size_t i = 0; i + ahead < seen.size(); ++i) {
    const auto predicted = predictor.update({&seen[i], 1}, period * i)[0];
    for (int h = 0; h < predicted.hypotheses; ++h)
      error[std::min<std::size_t>(i / lap, 2)] +=
          predicted.weights[h] * apart(predicted.at(h, 1.2).pose, seen[i + ahead].pose) / lap;
  }
  EXPECT_GT(error[0], 0.3);
  EXPECT_LT(error[2], 0.5 * error[0]);
}

TEST(Predictor, ACarThatBrakesIsExpectedToBrake) {
  Predictor predictor(circle());
  const auto speed = [](double time) { return time < 1 ? 4.0 : 4 - 4 * (time - 1); };
  const auto arc = [](double time) {
    return time < 1 ? 4 * time : 4 + 4 * (time - 1) - 2 * (time - 1) * (time - 1);
  };
  const auto car = [&](double time) { return object_at(beside(arc(time), 0), speed(time)); };
  EXPECT_LT(weight_near(shown(predictor, 0, 40, car), beside(arc(1.8), 0), 0.8, 0.2), 0.15);
  EXPECT_GT(weight_near(shown(predictor, 41, 64, car), beside(arc(2), 0), 0.4, 0.2), 0.5);
}

TEST(Predictor, ACarThatGetsUpToSpeedIsExpectedToGoOn) {
  constexpr double acceleration = 4, slow = 0.6;  // m/s^2, m/s
  const auto arc = [](double time) { return slow * time + 0.5 * acceleration * time * time; };
  Predictor predictor(circle());
  const auto predicted = shown(predictor, 0, 20, [&](double time) {  // 0.5 s, to 2.6 m/s
    return object_at(beside(arc(time), 0), slow + acceleration * time);
  });
  EXPECT_GT(weight_near(predicted, beside(arc(0.8), 0), 0.3, 0.12), 0.7);
  // The course's 4 m/s from 0.85 s on.
  EXPECT_GT(weight_near(predicted, beside(arc(0.85) + 4 * 0.65, 0), 1, 0.25), 0.7);
}

TEST(Predictor, SpeedsFollowTheCourse) {
  std::vector<maps::ReferencePoint> path = circle();
  for (std::size_t i = 150; i < 300; ++i) path[i].speed = 2;
  Predictor predictor(path);
  const TrackedObject now = object_at(beside(pi * radius - 1, 0), 3);  // 1 m before its speed halves
  const auto predicted = predictor.update({&now, 1}, 0);
  ASSERT_EQ(predicted.size(), 1u);
  // After 1 m at 3 m/s: 1.5 m/s.
  EXPECT_GT(weight_near(predicted[0], beside(pi * radius + 1, 0), 1, 0.2), 0.7);
}

TEST(Predictor, WithoutACourseTurnRateAndSpeedAreKept) {
  Predictor predictor;
  const auto predicted =
      after_two_seconds(predictor, [](double time) { return object_at(beside(3 * time, 0), 3, 3 / radius); });
  ASSERT_EQ(predicted.hypotheses, 2);
  EXPECT_GT(weight_near(predicted, beside(9, 0), 1, 0.05), 0.8);
}

TEST(Predictor, WeightsSumToOneAndDeviationsGrow) {
  Predictor predictor(circle());
  const auto predicted = after_two_seconds(
      predictor, [](double time) { return object_at(beside(3 * time, 0.2 * std::sin(3 * time)), 3); });
  double sum = 0;
  for (const double weight : predicted.weights) sum += weight;
  EXPECT_NEAR(sum, 1, 1e-12);
  ASSERT_EQ(predicted.poses.size(), 4 * predicted.times());
  for (std::size_t k = 1; k < predicted.times(); ++k) {
    EXPECT_GT(predicted.poses[k].along_deviation, predicted.poses[k - 1].along_deviation);
    EXPECT_GT(predicted.poses[k].across_deviation, predicted.poses[k - 1].across_deviation);
  }
  EXPECT_NEAR(predicted.poses[0].along_deviation, 0.03, 1e-9);
}

TEST(Predictor, StampsThatJumpMakeAnObjectUnknownAgain) {
  const TrackedObject then = object_at(beside(0, 0.6), 3), now = object_at(beside(4, 0.6), 3);
  Predictor fresh(circle());
  const maps::PredictedObstacle unknown = fresh.update({&now, 1}, 0)[0];
  for (const double stamp : {1e7, -5.0, 1e300}) {
    Predictor predictor(circle());
    const maps::PredictedObstacle known = after_two_seconds(predictor, [&](double) { return then; });
    EXPECT_NE(known.weights, unknown.weights);
    EXPECT_EQ(predictor.update({&now, 1}, stamp)[0].weights, unknown.weights) << stamp;
  }
}

TEST(Predictor, WhatStandsOrWhoseSpeedIsNotKnownIsNotPredicted) {
  Predictor predictor(circle());
  const TrackedObject standing = object_at(beside(0, 0), 0.3);
  EXPECT_TRUE(predictor.update({&standing, 1}, 0).empty());
  TrackedObject unknown = object_at(beside(0, 0), 3);
  unknown.covariance[3][3] = 4;
  EXPECT_TRUE(predictor.update({&unknown, 1}, 1).empty());
}

TEST(Predictor, AllocatesNothingAndKeepsToItsCapacity) {
  Predictor predictor(circle());
  std::vector<TrackedObject> objects;
  for (int i = 0; i < 40; ++i) {
    objects.push_back(object_at(beside(0.9 * i, 0), 3));
    objects.back().id = i;
  }
  const long before = testing::allocations();
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(predictor.update(objects, period * i).size(), 32u);
    objects[i].id += 100;
  }
  EXPECT_EQ(testing::allocations(), before);
}

TEST(Predictor, RefusesCoursesThatAreTooShortOrTooLong) {
  EXPECT_THROW(Predictor(std::vector<maps::ReferencePoint>(2)), std::invalid_argument);
  const std::vector<maps::ReferencePoint> far{
      {1e6, 0, 0, 1}, {0, 1e6, 0, 1}, {-1e6, 0, 0, 1}, {0, -1e6, 0, 1}};
  EXPECT_EQ(message_of([&] { Predictor{far}; }).substr(0, 8), "course: ");
}

}  // namespace
}  // namespace slalom::tracking::predictor_test
