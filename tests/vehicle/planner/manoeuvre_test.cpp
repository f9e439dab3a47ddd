// Turning in three points, in a lane.
// The room that obstacles leave along the path.
#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "support/lane.hpp"
#include "vehicle/planner/manoeuvre.hpp"
#include "vehicle/planner/passage.hpp"

namespace slalom::vehicle::detail::manoeuvre_test {
namespace {

const BodyOptions body{.margin = 0.05};
constexpr double wheelbase = 0.33, steer_limit = 0.4189, period = 0.025, sight = 2.36;

/// A lane along the x axis, 2 m wide, as a car sees it.
class Lane {
 public:
  explicit Lane(double half = 1, const maps::ClearanceMapOptions& options = {.length_x = 10,
                                                                             .length_y = 10,
                                                                             .center_x = 1,
                                                                             .reach = 0.5})
      : map_(options) {
    for (double x = 0; x < 60; x += 0.03)
      for (const double side : {-half, half}) walls_.push_back({x, side});
  }
  const maps::ClearanceMap& seen_from(const maps::Pose& pose) {
    map_.clear();
    std::vector<maps::Point> seen;
    for (const maps::Point& wall : walls_) seen.push_back(maps::inverse_transform(pose, wall));
    map_.add(std::span<const maps::Point>(seen));
    return map_;
  }

 private:
  std::vector<maps::Point> walls_;
  maps::ClearanceMap map_;
};

/// Drives a car with exact brakes until its way ends. Returns its last pose.
maps::Pose driven(Manoeuvre& manoeuvre, Lane& lane, maps::Pose pose, const BodyOptions& car = body,
                  double axles = wheelbase, double steer_rate = 3.2) {
  double speed = 0, steer = 0;
  for (int k = 0; k < 2000 && manoeuvre.active(); ++k) {
    auto command = manoeuvre.follow(lane.seen_from(pose), pose, speed, steer, period);
    if (!command && !manoeuvre.active()) break;
    if (!command) {  // beside the way: it stops and searches again
      command = Command{steer, 0};
      if (std::abs(speed) < 0.1) {
        EXPECT_TRUE(manoeuvre.search(lane.seen_from(pose), pose, static_cast<int>(10 * pose.x), -1e3, sight));
      }
    }
    steer += std::clamp(command->steer - steer, -steer_rate * period, steer_rate * period);
    speed += std::clamp(command->speed - speed, -6 * period, 4 * period);
    const double turned = speed * period * std::tan(steer) / axles, middle = pose.yaw + 0.5 * turned;
    pose = {pose.x + speed * period * std::cos(middle), pose.y + speed * period * std::sin(middle),
            maps::wrap_angle(pose.yaw + turned)};
    const maps::ClearanceMap& map = lane.seen_from(pose);
    for (const double x : {-car.rear, 0.5 * (car.front - car.rear), car.front})
      for (const double y : {-0.5 * car.width, 0.5 * car.width})
        EXPECT_GT(map.at(x, y), 0) << "at " << pose.x << ", " << pose.y;
  }
  return pose;
}

TEST(Manoeuvre, TurnsACarRoundInALane) {
  Manoeuvre manoeuvre(testing::lane(5), false, body, wheelbase, steer_limit);
  for (const double yaw : {3.14, 2.0, -1.57, -2.6}) {
    Lane lane;
    const maps::Pose start{10, 0.2, yaw};
    const maps::ClearanceMap& map = lane.seen_from(start);
    const long before = testing::allocations();
    const bool found = manoeuvre.search(map, start, 100, -1e3, sight);
    EXPECT_EQ(testing::allocations(), before);
    ASSERT_TRUE(found) << yaw;
    const maps::Pose end = driven(manoeuvre, lane, start);
    EXPECT_LT(std::abs(end.yaw), 0.7) << "from " << yaw;
    EXPECT_LT(std::abs(end.y), 1) << "from " << yaw;
  }
}

TEST(Manoeuvre, AWayThatIsFoundCanBeBegun) {
  Manoeuvre manoeuvre(testing::lane(5), false, body, wheelbase, steer_limit);
  Lane lane;
  int found = 0;
  for (double y = -0.5; y < 0.52; y += 0.05)  // free of the walls in any heading
    for (double yaw = 1.8; yaw < 4.5; yaw += 0.1) {
      const maps::Pose start{10, y, maps::wrap_angle(yaw)};
      const maps::ClearanceMap& map = lane.seen_from(start);
      if (!manoeuvre.search(map, start, 100, -1e3, sight)) continue;
      ++found;
      EXPECT_TRUE(manoeuvre.follow(map, start, 0, 0, period)) << "from y " << y << ", yaw " << yaw;
    }
  EXPECT_GT(found, 500);
}

TEST(Manoeuvre, ACarOfFullSizeTurnsRoundInAStreetOfEightMetres) {
  const BodyOptions passenger{.front = 3.68, .rear = 0.83, .width = 1.61, .margin = 0.3, .soft_margin = 1};
  Lane street(4, {.length_x = 60, .length_y = 40, .resolution = 0.25, .center_x = 10, .reach = 2});
  Manoeuvre manoeuvre(testing::lane(5), false, passenger, 2.58, 0.5);
  const maps::Pose start{30, 0.3, 3.14};
  ASSERT_TRUE(manoeuvre.search(street.seen_from(start), start, 300, -1e3, sight));
  const maps::Pose end = driven(manoeuvre, street, start, passenger, 2.58, 0.4);
  EXPECT_FALSE(manoeuvre.active()) << "at its end";
  EXPECT_LT(std::abs(end.yaw), 0.7);
  EXPECT_LT(std::abs(end.y), 4);
}

TEST(Manoeuvre, FindsNoWayWhereThereIsNone) {
  Manoeuvre manoeuvre(testing::lane(5), false, body, wheelbase, steer_limit);
  Lane narrow(0.25);
  const maps::Pose start{10, 0, 3.14};
  EXPECT_FALSE(manoeuvre.search(narrow.seen_from(start), start, 100, -1e3, sight));
  EXPECT_FALSE(manoeuvre.active());
}

constexpr maps::Pose car{10, 0, 0};  // on the course
const BodyOptions wide_body{.margin = 0.05, .soft_margin = 0.25};

/// Two walls along the way, `width` (m) apart from 3 m to 4.5 m ahead of the car, and 2.2 m elsewhere.
maps::ClearanceMap pinch(double width) {
  maps::ClearanceMap map({.length_x = 18, .length_y = 16, .center_x = 6, .reach = 0.5});
  std::vector<maps::Point> points;
  for (double x = -2; x < 12; x += 0.02)
    for (const double side : {-1.0, 1.0}) points.push_back({x, side * (x > 3 && x < 4.5 ? width / 2 : 1.1)});
  for (double y = width / 2; y < 1.1; y += 0.02)
    for (const double side : {-y, y})
      for (const double x : {3.0, 4.5}) points.push_back({x, side});
  map.add(std::span<const maps::Point>(points));
  return map;
}

WidestWay way_through(double width) {
  Passage passage(testing::lane(5), false, wide_body);
  WidestWay way;
  const auto map = pinch(width);
  const long before = testing::allocations();
  way = passage.search(map, car, 100, 8);
  EXPECT_EQ(testing::allocations(), before);
  return way;
}

TEST(Passage, MarginsFitIntoTheNarrowestPlace) {
  const WidestWay open = way_through(1.6);
  EXPECT_EQ(open.margin_share, 1);
  EXPECT_EQ(open.soft_share, 1);
  EXPECT_GT(open.top_speed, 100);

  const WidestWay narrow = way_through(0.7);
  EXPECT_EQ(narrow.margin_share, 1);
  EXPECT_GT(narrow.soft_share, 0.2);
  EXPECT_LT(narrow.soft_share, 0.7) << "0.35 m to each side, of which the body takes 0.18 m";
  EXPECT_LT(narrow.top_speed, 10);

  const WidestWay narrower = way_through(0.54);
  EXPECT_LT(narrower.margin_share, 1);
  EXPECT_LT(narrower.top_speed, narrow.top_speed);
}

TEST(Passage, AnOpenPlaceSlowsNoCarWhateverItsMargins) {
  const maps::ClearanceMap open({.length_x = 18, .length_y = 16, .center_x = 6, .reach = 0.6});
  for (int margin = 1; margin <= 10; ++margin)
    for (int soft = 1; soft <= 20; ++soft) {
      const BodyOptions body{.margin = 0.01 * margin, .soft_margin = 0.01 * soft};
      const WidestWay way = Passage(testing::lane(5), false, body).search(open, car, 100, 8);
      EXPECT_EQ(way.soft_share, 1);
      EXPECT_GT(way.top_speed, 100) << margin << ' ' << soft;
    }
}

}  // namespace

}  // namespace slalom::vehicle::detail::manoeuvre_test
