// Speed profiles, and checks of a course's line and profile: known answers on circles and straights.
#include "slalom/vehicle/course/course_check.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace slalom::vehicle::course_check_test {
namespace {

constexpr double pi = 3.141592653589793;

/// Points round a circle of this radius (m), counter-clockwise or, with `way` -1, clockwise.
std::vector<maps::Point> ring(double radius, int count, int way = 1) {
  std::vector<maps::Point> points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * pi * way * i / count;
    points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return points;
}

/// A circle of `radius` (m) at `speed` (m/s) in a free square map of 20 m.
Course circle(double radius, double speed) {
  Course course{.map = {200, 200, 0.1, {-10, -10, 0}, {}}};
  course.map.cells.assign(40000, maps::Occupancy::free);
  for (const maps::Point& point : ring(radius, 200))
    course.waypoints.push_back({point.x, point.y, 0, speed, 0});
  complete_course(course);
  return course;
}

/// The highest speeds along a closed path whose points are `step` (m) apart.
std::vector<double> speed_profile(const std::vector<double>& curvature, double step,
                                  const SpeedLimits& limits) {
  const std::size_t n = curvature.size();
  return feasible_speeds(std::vector<double>(n, limits.top_speed), curvature, std::vector<double>(n, step),
                         true, limits);
}

TEST(SpeedProfile, IsTheLateralLimitOnACircleAndTheTopSpeedOnALine) {
  const SpeedLimits limits;
  for (const double v : speed_profile(std::vector<double>(50, 0.5), 0.1, limits))
    EXPECT_NEAR(v, std::sqrt(limits.lateral_acceleration / 0.5), 1e-12);
  for (const double v : speed_profile(std::vector<double>(50, 0.0), 0.1, limits))
    EXPECT_EQ(v, limits.top_speed);
}

TEST(SpeedProfile, LeavesASlowPointAtTheLimitsOfMotorAndBrakes) {
  // One tight row on an otherwise straight closed path: v^2 grows by 2 a s to both sides (a is shared with
  // turning at the tight row itself, where all of the tyres' force is used).
  SpeedLimits limits{100, 4, 2, 3};
  std::vector<double> curvature(200, 0.0);
  curvature[120] = 4.0;
  const auto v = speed_profile(curvature, 0.1, limits);
  EXPECT_NEAR(v[120], 1.0, 1e-12);
  EXPECT_NEAR(v[121], 1.0, 1e-12);
  EXPECT_NEAR(v[119], 1.0, 1e-12);
  for (int k = 0; k < 60; ++k) EXPECT_NEAR(v[121 + k] * v[121 + k], 1 + 2 * 2 * 0.1 * k, 1e-9);
  for (int k = 0; k < 60; ++k) EXPECT_NEAR(v[119 - k] * v[119 - k], 1 + 2 * 3 * 0.1 * k, 1e-9);
}

TEST(SpeedProfile, RejectsLimitsThatAreNotPositive) {
  const std::vector<double> curvature(10, 0.1);
  EXPECT_THROW(speed_profile(curvature, 0.1, {0, 4, 2, 3}), std::invalid_argument);
  EXPECT_THROW(speed_profile(curvature, 0.1, {5, -4, 2, 3}), std::invalid_argument);
  EXPECT_THROW(speed_profile(curvature, 0.1, {5, 4, std::nan(""), 3}), std::invalid_argument);
  EXPECT_THROW(speed_profile(curvature, 0.1, {5, 4, 2, INFINITY}), std::invalid_argument);
  EXPECT_THROW(speed_profile({0.1, std::nan(""), 0.1}, 0.1, {5, 4, 2, 3}), std::invalid_argument);
}

TEST(PathGeometry, GivesTheCurvatureOfACircleWithItsSign) {
  const PathGeometry path = path_geometry(ring(4, 100, -1));
  EXPECT_TRUE(path.closed);
  for (const double k : path.curvature) EXPECT_NEAR(k, -0.25, 1e-3);
}

TEST(PathGeometry, DoesNotShowRoundedCoordinates) {
  // To 1 mm, at steps of 0.1 m: their second differences would give an error of 0.1 / m.
  std::vector<maps::Point> points = ring(8, 500);
  for (maps::Point& p : points) p = {std::round(1000 * p.x) / 1000, std::round(1000 * p.y) / 1000};
  for (const double k : path_geometry(points).curvature) EXPECT_NEAR(k, 0.125, 0.02);
}

TEST(PathGeometry, IsOpenWhereTheEndsAreApart) {
  std::vector<maps::Point> points;
  for (int i = 0; i < 50; ++i) points.push_back({0.2 * i, 0});
  const PathGeometry path = path_geometry(points);
  EXPECT_FALSE(path.closed);
  for (const double k : path.curvature) EXPECT_EQ(k, 0);
}

TEST(CourseCheck, FindsNothingOnASlowCircleInTheOpen) {
  const CourseCheckOptions options;
  const CourseCheck check = check_course(circle(4, 4), options);  // v^2 / r = 4 m/s^2
  EXPECT_TRUE(check.grip.stretches.empty());
  EXPECT_TRUE(check.walls.stretches.empty());
  EXPECT_TRUE(sentences(check, options).empty());
  EXPECT_NEAR(check.max_acceleration, 4, 0.05);
}

TEST(CourseCheck, FindsNoWallInTheOpenForACarOfAnyWidth) {
  const Course course = circle(4, 4);
  for (int millimetres = 100; millimetres < 400; millimetres += 5) {
    const CourseCheck check =
        check_course(course, {.half_width = millimetres * 1e-3, .margin = 0.055, .limits = {}});
    EXPECT_TRUE(check.walls.stretches.empty()) << millimetres;
  }
  EXPECT_TRUE(check_course(course, {.half_width = 1e6, .margin = 0, .limits = {}}).walls.stretches.empty());
}

TEST(ReachableMap, APointThatIsNoNumberReachesNothing) {
  Course course = circle(4, 4);
  course.waypoints.assign(3, {std::nan(""), std::nan(""), 0, 1, 0});
  for (const maps::Occupancy cell : reachable_map(course).cells) EXPECT_NE(cell, maps::Occupancy::free);
}

TEST(CourseCheck, FindsAProfileThatAsksForTooMuchGrip) {
  Course course = circle(4, 4);
  for (int i = 50; i < 100; ++i) course.waypoints[i].speed = 6;  // 9 m/s^2
  const CourseCheckOptions options{.limits = {20, 5, 100, 100}};
  const CourseCheck check = check_course(course, options);
  ASSERT_EQ(check.grip.stretches.size(), 1u);
  EXPECT_NEAR(check.grip.share, 0.25, 0.01);
  EXPECT_NEAR(check.grip.stretches[0].begin, course.length * 0.245, 0.2);
  EXPECT_NEAR(check.grip.stretches[0].end, course.length * 0.5, 0.2);
  // Between the two speeds it also asks for (36 - 16) / (2 0.126 m) along the line.
  EXPECT_NEAR(check.grip.stretches[0].value, std::hypot(9, 20 / (2 * course.length / 200)), 1);
  const auto said = sentences(check, options);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("25.5 % of its length"), std::string::npos) << said[0];
}

TEST(CourseCheck, FindsALineThatIsTooNearAWall) {
  Course course = circle(4, 1);
  // A wall whose nearer side is 0.1 m outside the circle at its rightmost point.
  for (int y = 98; y <= 101; ++y) course.map.at(141, y) = maps::Occupancy::occupied;
  const CourseCheckOptions options{.half_width = 0.15, .margin = 0.05, .limits = {}};
  const CourseCheck check = check_course(course, options);
  ASSERT_FALSE(check.walls.stretches.empty());
  EXPECT_NEAR(check.min_distance, 0.1, 0.01);
  EXPECT_NEAR(check.walls.stretches[0].worst.x, 4, 0.05);
  EXPECT_LT(check.walls.share, 0.05);
  EXPECT_TRUE(
      check_course(course, {.half_width = 0.05, .margin = 0.04, .limits = {}}).walls.stretches.empty());
}

TEST(CourseCheck, AProfileMadeFeasiblePassesTheCheckAndIsNowhereFaster) {
  Course course = circle(4, 4);
  for (int i = 50; i < 100; ++i) course.waypoints[i].speed = 6;
  const Course before = course;
  const CourseCheckOptions options{.limits = {20, 5, 3, 4}};
  make_feasible(course, options.limits);
  EXPECT_TRUE(check_course(course, options).grip.stretches.empty());
  for (std::size_t i = 0; i < course.waypoints.size(); ++i)
    EXPECT_LE(course.waypoints[i].speed, before.waypoints[i].speed);
  EXPECT_NEAR(course.waypoints[75].speed, std::sqrt(5 * 4.0), 0.02);
  EXPECT_EQ(course.waypoints[20].speed, 4);
}

TEST(CourseCheck, AnOpenPathNeedsNoSpeedForItsMissingStretch) {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 100; ++i) path.push_back({0.2 * i, 0, 0, i < 50 ? 2.0 : 8.0});
  make_feasible(path, {10, 9, 3, 3});
  EXPECT_EQ(path[0].speed, 2);
  EXPECT_NEAR(path[60].speed * path[60].speed, 4 + 2 * 3 * 0.2 * 11, 1e-9);
  EXPECT_GT(path[99].speed, 7.5);
}

}  // namespace
}  // namespace slalom::vehicle::course_check_test
