// Ways with changes between forward and reverse, for bodies that steer and for those that turn on the spot.
#include "slalom/maps/manoeuvre_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/allocations.hpp"

namespace slalom::maps::manoeuvre_search_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double nothing = 1e3;

/// A body in a street between y = -half and y = half that ends at x = end, m.
class Street final : public BodyRoom {
 public:
  Street(double front, double rear, double width, double half, double end = nothing)
      : corners_{{-rear, -width / 2}, {front, -width / 2}, {front, width / 2}, {-rear, width / 2}},
        half_(half),
        end_(end) {}
  double at(const Pose& pose) const noexcept override {
    double room = nothing;
    for (const Point& corner : corners_) {
      const Point place = transform(pose, corner);
      const double half = place.x < widening ? wide_half : half_;
      room = std::min({room, half - std::abs(place.y), end_ - place.x});
    }
    return room;
  }
  double widening = -nothing, wide_half = 0;  ///< m: before this x, the street is wider

 private:
  Point corners_[4];
  double half_, end_;
};

const Street square(0.35, 0.35, 0.5, nothing);

double length_of(std::span<const Pose> poses) {
  double sum = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    sum += std::hypot(poses[i].x - poses[i - 1].x, poses[i].y - poses[i - 1].y);
  return sum;
}

/// Checks that the poses are free and those of a vehicle with this turning radius (m). Returns the number of
/// parts driven in reverse.
int check(const ManoeuvreSearch& search, const BodyRoom& room) {
  const auto poses = search.poses();
  int reversed = 0, before = 1;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose &a = poses[i - 1], &b = poses[i];
    EXPECT_GE(room.at(b), 0) << i;
    const double way = std::hypot(b.x - a.x, b.y - a.y), turn = std::abs(wrap_angle(b.yaw - a.yaw));
    if (way < 1e-9) continue;
    const Point local = inverse_transform({a.x, a.y, a.yaw + 0.5 * wrap_angle(b.yaw - a.yaw)}, {b.x, b.y});
    EXPECT_NEAR(local.y, 0, 1e-3 * way + 1e-5) << i;
    EXPECT_LE(turn * search.options().radius, 1.01 * way + 1e-5) << i;
    const int gear = local.x > 0 ? 1 : -1;
    if (gear < 0 && before > 0) ++reversed;
    before = gear;
  }
  return reversed;
}

TEST(ManoeuvreSearch, ReachesEveryPoseExactlyOnAFreeFloor) {
  for (const double radius : {0.0, 0.5})
    for (const bool can_reverse : {true, false}) {
      ManoeuvreOptions options = ManoeuvreOptions::of(0.7, radius);
      options.can_reverse = can_reverse;
      ManoeuvreSearch search(options);
      for (double angle = -3; angle < 3; angle += 0.5)
        for (const double yaw : {0.0, 1.5, 3.0, -2.0}) {
          const ManoeuvreGoal goal[] = {{{1.2 * std::cos(angle), 1.2 * std::sin(angle), yaw}}};
          const long before = testing::allocations();
          const bool found = search.search(square, goal);
          EXPECT_EQ(testing::allocations(), before);
          ASSERT_TRUE(found) << angle << " " << yaw;
          const Pose& end = search.poses().back();
          EXPECT_NEAR(end.x, goal[0].pose.x, 1e-4);
          EXPECT_NEAR(end.y, goal[0].pose.y, 1e-4);
          EXPECT_NEAR(wrap_angle(end.yaw - yaw), 0, 1e-4);
          const int reversed = check(search, square);
          EXPECT_TRUE(can_reverse || reversed == 0);
          if (radius == 0) {
            EXPECT_NEAR(length_of(search.poses()), 1.2, 1e-4);
          }
        }
    }
}

TEST(ManoeuvreSearch, TakesTheGoalFromWhichLeastIsLeftToDrive) {
  ManoeuvreSearch search(ManoeuvreOptions::of(0.7, 0.5));
  const ManoeuvreGoal goals[] = {{{1, 0, 0}, 2}, {{2, 0, 0}, 0.5}, {{3, 0, 0}, 0}};
  ASSERT_TRUE(search.search(square, goals));
  EXPECT_EQ(search.goal(), 1u);
}

TEST(ManoeuvreSearch, ReversingAndCuspsHaveAPrice) {
  ManoeuvreSearch search(ManoeuvreOptions::of(0.7, 0.5));
  const ManoeuvreGoal behind[] = {{{-1, 0, 0}}}, aside[] = {{{0, 1, pi}}};
  ASSERT_TRUE(search.search(square, behind));
  EXPECT_NEAR(search.poses()[1].yaw, 0, 1e-9) << "straight back";
  ASSERT_TRUE(search.search(square, aside));
  EXPECT_EQ(check(search, square), 0) << "half a circle";
}

TEST(ManoeuvreSearch, DrivesALoopRatherThanBackWhereNoSensorLooks) {
  ManoeuvreOptions options = ManoeuvreOptions::of(0.58, 0.5);
  options.beside = 0.3;
  options.turned = 0.3;
  options.rear = 0.1;
  ManoeuvreSearch search(options);
  const ManoeuvreGoal behind[] = {{{-1.2, 0, 0}}};
  ASSERT_TRUE(search.search(square, behind));
  EXPECT_GE(check(search, square), 1);
  ASSERT_TRUE(search.search(square, behind, 2.36));
  EXPECT_EQ(check(search, square), 0);
}

TEST(ManoeuvreSearch, ABodyThatCannotTurnWhereItIsDrivesBackToAWiderPart) {
  ManoeuvreOptions options = ManoeuvreOptions::of(0.7, 0);
  ManoeuvreSearch search(options);
  Street blind(0.35, 0.35, 0.5, 0.3, 0.5);  // too narrow to turn round
  blind.widening = -0.8;
  blind.wide_half = 1;
  const ManoeuvreGoal goal[] = {{{-1.5, 0, pi}}};
  ASSERT_TRUE(search.search(blind, goal));
  EXPECT_EQ(check(search, blind), 1);
  options.can_reverse = false;
  EXPECT_FALSE(ManoeuvreSearch(options).search(blind, goal));
  Street narrow(0.35, 0.35, 0.5, 0.3);
  EXPECT_FALSE(search.search(narrow, goal)) << "nowhere";
}

/// A car of 4.5 m in a street of 6 m, whose lengths are those of its body, or of a 1/10-scale car.
TEST(ManoeuvreSearch, ALargeCarTurnsRoundOnItsOwnLengths) {
  const Street street(3.68, 0.83, 1.61, 3);
  std::vector<ManoeuvreGoal> goals;
  for (double x = -20; x <= 20; x += 0.5) goals.push_back({{x, 0, pi}});
  for (const double length : {4.51, 0.58}) {
    ManoeuvreOptions options = ManoeuvreOptions::of(length, 5.5);
    options.beside = body_scale(length);
    options.turned = 0.5;
    ManoeuvreSearch search(options);
    EXPECT_EQ(search.search(street, goals), length > 1);
    if (length > 1) {
      EXPECT_GE(check(search, street), 1);
    }
  }
}

}  // namespace
}  // namespace slalom::maps::manoeuvre_search_test
