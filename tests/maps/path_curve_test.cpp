#include "slalom/maps/path_curve.hpp"

#include <gtest/gtest.h>

namespace slalom::maps::path_curve_test {
namespace {

constexpr double pi = std::numbers::pi;

PathCurve curve_of(const std::vector<Pose>& poses, bool turns_on_the_spot) {
  PathCurve curve;
  curve.reserve(2000);
  curve.set(poses, turns_on_the_spot);
  return curve;
}

TEST(PathCurve, EndsALegWhereTheDirectionOfTravelChanges) {
  const PathCurve curve = curve_of({{0, 0, 0}, {4.02, 0, 0}, {2.5, 0, 0}}, true);
  ASSERT_EQ(curve.legs().size(), 2U);
  EXPECT_FALSE(curve.legs()[0].backward);
  EXPECT_TRUE(curve.legs()[1].backward);
  EXPECT_NEAR(curve.points()[curve.legs()[0].last].x, 4.02, 1e-12);
  for (const Pose& point : curve.points()) EXPECT_NEAR(wrap_angle(point.yaw), 0, 1e-9);
}

TEST(PathCurve, TurnsOnTheSpotAtCornersAndAtTheGoal) {
  const std::vector<Pose> path{{0, 0, 0}, {2, 0, pi / 2}, {2, 0.6, pi}, {0, 0.6, 0.5}};
  const PathCurve curve = curve_of(path, true);
  ASSERT_EQ(curve.legs().size(), 6U);
  EXPECT_TRUE(curve.legs()[1].turns && curve.legs()[3].turns && curve.legs()[5].turns);
  EXPECT_NEAR(curve.legs()[1].yaw, pi / 2, 1e-9);
  EXPECT_NEAR(curve.legs()[5].yaw, 0.5, 1e-12);
  EXPECT_NEAR(curve.points()[curve.legs()[0].last].x, 2, 1e-12);
  EXPECT_NEAR(curve.points()[curve.legs()[2].last].y, 0.6, 1e-12);
  EXPECT_EQ(curve_of(path, false).legs().size(), 1U);
}

TEST(PathCurve, AWideBendIsNoCorner) {
  std::vector<Pose> bend;
  for (double angle = 0; angle < pi; angle += 0.02)
    bend.push_back({0.3 * std::sin(angle), 0.3 - 0.3 * std::cos(angle), angle});
  bend.push_back({-1, 0.6, pi});
  EXPECT_EQ(curve_of(bend, true).legs().size(), 1U);
}

TEST(PathCurve, ProgressNeverJumpsToALaterPass) {
  PathCurve loop = curve_of({{0, 0, 0}, {5, 0, pi / 2}, {5, 5, pi}, {0, 5, -pi / 2}, {0, 0, 0}}, false);
  loop.place({0, 0});
  EXPECT_EQ(loop.nearest(), 0U);
  EXPECT_NEAR(loop.remaining(), 20, 1e-9);
  for (double x = 0; x < 5; x += 0.1) loop.advance({x, 0.01});
  EXPECT_NEAR(loop.remaining(), 15, 0.2);
  // Past the goal, and back in: the first pass is another leg.
  PathCurve dock = curve_of({{0, 0, 0}, {4, 0, 0}, {2, 0, 0}}, true);
  dock.place({0, 0});
  for (double x = 0; x <= 4; x += 0.1) dock.advance({x, 0});
  EXPECT_NEAR(dock.remaining(), 2, 0.15);
  EXPECT_FALSE(dock.on_last_leg());
  dock.next_leg();
  EXPECT_TRUE(dock.on_last_leg());
  dock.advance({1, 0});  // never back beyond the leg
  EXPECT_GE(dock.nearest(), dock.leg().first);
}

TEST(PathCurve, APathOfOnePoseIsATurn) {
  PathCurve curve = curve_of({{1, 1, 2}}, true);
  curve.place({1, 1});
  EXPECT_TRUE(curve.leg().turns);
  EXPECT_EQ(curve.leg().yaw, 2);
  EXPECT_EQ(curve.remaining(), 0);
}

}  // namespace
}  // namespace slalom::maps::path_curve_test
