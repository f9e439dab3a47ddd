// The search for a path around what blocks the course.
#include "vehicle/planner/detour.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "support/allocations.hpp"
#include "support/lane.hpp"

namespace slalom::vehicle::detail::detour_test {
namespace {

constexpr double period = 0.025;
constexpr maps::Pose car{10, 0, 0};  // on the course
const BodyOptions body;

constexpr int nearest = 100;

/// Walls across the way, 2 m ahead of the car, each from its right to its left end (m) as the car sees them.
class Walls {
 public:
  Walls(std::initializer_list<std::pair<double, double>> walls) {
    for (const auto& [right, left] : walls)
      for (double y = right; y <= left; y += 0.04) points_.push_back({2, y});
    map_.add(std::span<const maps::Point>(points_));
  }
  const maps::ClearanceMap& map() const { return map_; }
  double distance(const maps::ReferencePoint& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const maps::Point& each : points_)
      least = std::min(least, std::hypot(car.x + each.x - point.x, each.y - point.y));
    return least;
  }

 private:
  maps::ClearanceMap map_{{.length_x = 18, .length_y = 16, .center_x = 6, .reach = 0.6}};
  std::vector<maps::Point> points_;
};

/// m, left of the car, where a path crosses the wall.
double crossing(std::span<const maps::ReferencePoint> path) {
  for (const maps::ReferencePoint& point : path)
    if (point.x > car.x + 2) return point.y;
  return std::nan("");
}

/// Lets a car at `car` do what it does at this speed until the state changes to or from reversing.
void drive(maps::Recovery& recovery, double speed) {
  const bool before = recovery.reverses();
  while (recovery.reverses() == before)
    recovery.update({.arc = car.x, .speed = speed, .free_speed = 5}, period);
}

/// A recovery that has reversed at `car` and drives on.
maps::Recovery retrying() {
  maps::Recovery recovery(maps::RecoveryLengths::of(body.front + body.rear));
  drive(recovery, 0);
  drive(recovery, -0.45);
  return recovery;
}

TEST(Detour, LeadsThroughTheGapAndBackToTheCourse) {
  const Walls walls{{-9, 0.8}, {1.5, 9}};
  Detour detour(testing::lane(5), false, body);
  ASSERT_TRUE(detour.search(walls.map(), car, nearest));
  const auto path = detour.path();
  EXPECT_LT(std::hypot(path.front().x - car.x, path.front().y - car.y), 0.1);
  EXPECT_GT(crossing(path), 0.8);
  EXPECT_LT(crossing(path), 1.5);
  EXPECT_NEAR(path.back().y, 0, 1e-9);
  EXPECT_GT(path.back().x, car.x + 8);
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    SCOPED_TRACE(i);
    const double dx = path[i + 1].x - path[i].x, dy = path[i + 1].y - path[i].y;
    EXPECT_LT(std::hypot(dx, dy), 0.25);
    EXPECT_NEAR(path[i].yaw, std::atan2(dy, dx), 1e-12);
    EXPECT_EQ(path[i].speed, 1.5);
    EXPECT_GT(walls.distance(path[i]), body.width / 2 + body.margin - 0.1) << "but for a cell";
  }
  detour.update_field({car.x, car.y});
  const maps::ReferenceField& field = detour.field();
  EXPECT_LT(field.at(path[20].x, path[20].y).distance, 0.1);
  EXPECT_NEAR(field.at(path[20].x, path[20].y).speed, 1.5, 1e-6);
}

TEST(Detour, EndsWhereAnOpenCourseEnds) {
  const Walls walls{{-9, 0.8}, {1.5, 9}};
  const std::vector<maps::ReferencePoint> course = testing::lane(5);
  Detour detour(std::span<const maps::ReferencePoint>(course).first(160), false, body);
  ASSERT_TRUE(detour.search(walls.map(), car, nearest));
  EXPECT_NEAR(detour.path().back().x, 15.9, 0.2);
}

TEST(Detour, GoesOnOverTheSeamOfAClosedCourse) {
  const Walls walls{{-9, 0.8}, {1.5, 9}};
  std::vector<maps::ReferencePoint> course = testing::lane(5);
  std::rotate(course.begin(), course.begin() + 110, course.end());  // the seam is 1 m ahead of the car
  Detour detour(course, true, body);
  ASSERT_TRUE(detour.search(walls.map(), car, static_cast<int>(course.size()) - 10));
  EXPECT_GT(detour.path().back().x, car.x + 8);
}

TEST(Detour, PrefersTheShorterWay) {
  const Walls walls{{-9, -2.5}, {-1.5, 0.8}, {1.5, 9}};
  Detour detour(testing::lane(5), false, body);
  ASSERT_TRUE(detour.search(walls.map(), car, nearest));
  EXPECT_GT(crossing(detour.path()), 0);
}

TEST(Detour, FindsNoWayWhereThereIsNoneOrItIsTooNarrow) {
  Detour detour(testing::lane(5), false, body);
  EXPECT_FALSE(detour.search(Walls{{-9, 9}}.map(), car, nearest));
  EXPECT_FALSE(detour.search(Walls{{-9, 0.8}, {1.1, 9}}.map(), car, nearest));
}

TEST(Detour, TriesAnotherWayWhereTheCarHadToReverse) {
  const Walls walls{{-9, -2.5}, {-1.5, 0.8}, {1.5, 9}};
  Detour detour(testing::lane(5), false, body);
  maps::Recovery recovery = retrying();
  detour.note(recovery, car);
  ASSERT_TRUE(detour.search(walls.map(), car, nearest));
  const double first = crossing(detour.path());
  drive(recovery, 0);
  detour.note(recovery, {car.x + 2 - body.front, first, 0});  // stuck in the first gap
  drive(recovery, -0.45);
  detour.note(recovery, car);
  ASSERT_TRUE(detour.search(walls.map(), car, nearest));
  EXPECT_LT(crossing(detour.path()), 0);

  // Where the other way is closed, the first may be tried again.
  ASSERT_TRUE(detour.search(Walls{{-9, 0.8}, {1.5, 9}}.map(), car, nearest));
  EXPECT_NEAR(crossing(detour.path()), first, 0.1);

  // Past the place, the dead end is forgotten.
  detour.note(maps::Recovery({}), car);
  ASSERT_TRUE(detour.search(walls.map(), car, nearest));
  EXPECT_NEAR(crossing(detour.path()), first, 0.1);
}

TEST(Detour, AllocatesNothing) {
  const Walls walls{{-9, 0.8}, {1.5, 9}};
  Detour detour(testing::lane(5), false, body);
  const long before = testing::allocations();
  for (int k = 0; k < 5; ++k) {
    EXPECT_TRUE(detour.search(walls.map(), {car.x + 0.1 * k, 0.05 * k, 0.1 * k}, nearest + k));
    detour.update_field({car.x, car.y});
  }
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace slalom::vehicle::detail::detour_test
