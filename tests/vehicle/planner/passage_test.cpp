// The room that obstacles leave along the path.
#include "vehicle/planner/passage.hpp"

#include <gtest/gtest.h>

#include "support/allocations.hpp"
#include "support/lane.hpp"

namespace slalom::vehicle::detail::passage_test {
namespace {

constexpr maps::Pose car{10, 0, 0};  // on the course
const BodyOptions body{.margin = 0.05, .soft_margin = 0.25};

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
  Passage passage(testing::lane(5), false, body);
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

TEST(Passage, WithNarrowMarginsTheMapEndsBeforeTheUsualRoom) {
  const BodyOptions racing{.margin = 0.01, .soft_margin = 0.1};
  maps::ClearanceMap open({.length_x = 18, .length_y = 16, .center_x = 6, .reach = 0.3});
  const WidestWay way = Passage(testing::lane(5), false, racing).search(open, car, 100, 8);
  EXPECT_EQ(way.soft_share, 1);
  EXPECT_GT(way.top_speed, 100);
}

}  // namespace
}  // namespace slalom::vehicle::detail::passage_test
