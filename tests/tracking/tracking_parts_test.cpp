#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "slalom/tracking/object_tracker.hpp"
#include "support/allocation_failures.hpp"
#include "tracking/association.hpp"
#include "tracking/box_fit.hpp"
#include "tracking/map_background.hpp"
#include "tracking/readings.hpp"
#include "tracking/tracked.hpp"
#include "tracking/tracker_calls.hpp"

namespace slalom::tracking::tracking_parts_test {
namespace {

constexpr double pi = 3.141592653589793;

/// A scan of 1 degree per beam over a whole turn, beginning backwards.
struct RoundScan {
  std::vector<float> ranges = std::vector<float>(360, 5.0F);
  maps::LaserScanView view() const { return {ranges, -pi, pi / 180, 0.02, 30}; }
};

/// Readings along the outline of a box that face the origin.
std::vector<Reading> outline(const maps::Pose& pose, double length, double width) {
  std::vector<Reading> readings;
  for (int beam = 0; beam < 1440; ++beam) {
    const double angle = -pi + beam * pi / 720, c = std::cos(angle - pose.yaw),
                 s = std::sin(angle - pose.yaw);
    const maps::Point from = maps::inverse_transform(pose, {0, 0});
    double enter = 0, leave = std::numeric_limits<double>::infinity();
    for (const auto& [at, way, half] :
         {std::array{from.x, c, 0.5 * length}, std::array{from.y, s, 0.5 * width}}) {
      const double a = (-half - at) / way, b = (half - at) / way;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter < leave) readings.push_back({{enter * std::cos(angle), enter * std::sin(angle)}, enter, beam});
  }
  return readings;
}

TEST(BoxFit, FindsTheAngleOfEveryBox) {
  for (double yaw = 0; yaw < 3; yaw += 0.17) {
    for (double bearing = -3; bearing < 3; bearing += 0.7) {
      const auto readings = outline({2 * std::cos(bearing), 2 * std::sin(bearing), yaw}, 0.58, 0.31);
      const BoxFit fit = fit_box(readings, 0.005);
      EXPECT_NEAR(std::remainder(fit.angle - yaw, pi / 2), 0, 0.04) << yaw << " " << bearing;
      EXPECT_LT(fit.angle_deviation, 0.1);
    }
  }
}

TEST(Readings, TellEndsFromWhatIsHidden) {
  RoundScan scan;
  for (std::size_t i = 100; i < 120; ++i) scan.ranges[i] = 2;  // an object before the wall
  for (std::size_t i = 120; i < 130; ++i) scan.ranges[i] = 1;  // another one hides its left end
  Readings readings(360, 15);
  ASSERT_TRUE(readings.set(scan.view()));
  EXPECT_TRUE(readings.ends_at(100, -1, 0.26, 0.02));
  EXPECT_FALSE(readings.ends_at(119, 1, 0.26, 0.02));
  EXPECT_TRUE(readings.ends_at(129, 1, 0.26, 0.02));
  EXPECT_FALSE(readings.ends_at(110, 1, 0.26, 0.02)) << "the surface goes on";
  EXPECT_FALSE(readings.ends_at(0, -1, 0.26, 0.02)) << "the field of view ends";
  EXPECT_EQ(readings.beam_at(0), 180);
  EXPECT_EQ(readings.beam_at(2 * pi), 180);
  EXPECT_EQ(readings.beam_at(-pi / 2), 90);
}

TEST(Readings, RejectScansOfInvalidGeometry) {
  RoundScan scan;
  Readings readings(360, 15), small(100, 15);
  EXPECT_TRUE(readings.set(scan.view()));
  EXPECT_FALSE(small.set(scan.view()));
  EXPECT_FALSE(readings.set({}));
  auto view = scan.view();
  view.angle_increment = -0.01;
  EXPECT_FALSE(readings.set(view));
  view.angle_increment = 0.1;
  EXPECT_FALSE(readings.set(view)) << "more than a turn";
  view = scan.view();
  view.angle_min = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(readings.set(view));
  EXPECT_TRUE(readings.all().empty());
  scan.ranges[3] = std::numeric_limits<float>::quiet_NaN();
  scan.ranges[4] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(readings.set(scan.view()));
  EXPECT_EQ(readings.all().size(), 358U);
}

TEST(Clusters, BreakAtGapsAndAtLostBeamsOnlyIfFar) {
  RoundScan scan;
  for (std::size_t i = 100; i < 110; ++i) scan.ranges[i] = 2;
  scan.ranges[50] = 40;  // no return
  Readings readings(360, 15);
  ASSERT_TRUE(readings.set(scan.view()));
  readings.place({1, 2, 0.3});
  std::vector<Cluster> clusters, few;
  clusters.reserve(360);
  few.reserve(2);
  find_clusters(readings.all(), readings.increment(), {}, clusters);
  ASSERT_EQ(clusters.size(), 3U);
  EXPECT_EQ(clusters[0].end, 99U);
  EXPECT_EQ(clusters[1].end, 109U);
  find_clusters(readings.all(), readings.increment(), {}, few);
  EXPECT_EQ(few.size(), 2U);
}

TEST(Gaussian, CorrectsAsTheKalmanFilterDoes) {
  Gaussian<2> g{{1, 2}, {{4, 1}, {1, 3}}};
  g.correct({1, 0}, 2, 1);  // gain (4, 1) / 5
  EXPECT_DOUBLE_EQ(g.mean[0], 2.6);
  EXPECT_DOUBLE_EQ(g.mean[1], 2.4);
  EXPECT_DOUBLE_EQ(g.covariance[0][0], 0.8);
  EXPECT_DOUBLE_EQ(g.covariance[0][1], 0.2);
  EXPECT_DOUBLE_EQ(g.covariance[1][1], 2.8);
  EXPECT_DOUBLE_EQ(g.variance_along({1, 1}), 0.8 + 0.4 + 2.8);
}

/// A room of 8 x 6 m, turned, with walls of one cell.
maps::OccupancyGrid turned_room() {
  maps::OccupancyGrid map{160, 120, 0.05, {3, -2, 0.4}, {}};
  map.cells.assign(160 * 120, maps::Occupancy::free);
  for (int c = 0; c < 160; ++c) map.at(c, 0) = map.at(c, 119) = maps::Occupancy::occupied;
  for (int r = 0; r < 120; ++r) map.at(0, r) = map.at(159, r) = maps::Occupancy::occupied;
  return map;
}

TEST(MapBackground, KnowsTheDistanceToWallsOfATurnedMap) {
  const maps::OccupancyGrid map = turned_room();
  const MapBackground background(map);
  const auto at = [&](double x, double y) {
    return background.distance(maps::transform(map.origin, {x, y}));
  };
  EXPECT_NEAR(at(1, 3), 0.95, 0.01);
  EXPECT_NEAR(at(4, 5), 0.95, 0.01);
  EXPECT_NEAR(at(0.05, 3), 0, 0.01);
  EXPECT_EQ(at(-1, 3), 0) << "outside";
}

TEST(MapBackground, AlignsAPoseThatIsWrong) {
  const maps::OccupancyGrid map = turned_room();
  const MapBackground background(map);
  const maps::Point inside = maps::transform(map.origin, {3, 2});
  const maps::Pose truth{inside.x, inside.y, 1.1};
  RoundScan scan;
  for (std::size_t i = 0; i < 360; ++i) {
    const double angle = -pi + i * pi / 180 + truth.yaw - map.origin.yaw;
    const double c = std::cos(angle), s = std::sin(angle);
    scan.ranges[i] = static_cast<float>(
        std::min((c > 0 ? 7.95 - 3 : 3 - 0.05) / std::abs(c), (s > 0 ? 5.95 - 2 : 2 - 0.05) / std::abs(s)));
    if (i > 100 && i < 130) scan.ranges[i] = 1;  // something that is not on the map
  }
  Readings readings(360, 15);
  ASSERT_TRUE(readings.set(scan.view()));
  const maps::Pose wrong{truth.x + 0.06, truth.y - 0.05, truth.yaw + 0.03};
  const maps::Pose found = background.align(readings, wrong, 0.05, 0.03, 0.02);
  EXPECT_NEAR(found.x, truth.x, 0.01);
  EXPECT_NEAR(found.y, truth.y, 0.01);
  EXPECT_NEAR(found.yaw, truth.yaw, 0.004);
}

TEST(ObjectTrackerInput, IsChecked) {
  maps::OccupancyGrid map = turned_room();
  EXPECT_NO_THROW(ObjectTracker{map});
  map.resolution = 0;
  EXPECT_THROW(ObjectTracker{map}, std::invalid_argument);
  map = turned_room();
  map.cells.pop_back();
  EXPECT_THROW(ObjectTracker{map}, std::invalid_argument);

  const RoundScan scan;
  ObjectTracker tracker;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tracker.update({scan.view(), {nan, 0, 0}, 0}).status, TrackerStatus::bad_pose);
  EXPECT_EQ(tracker.update({scan.view(), {}, nan}).status, TrackerStatus::bad_pose);
  EXPECT_EQ(tracker.update({scan.view(), {}, 5}).status, TrackerStatus::ok);
  EXPECT_EQ(tracker.update({scan.view(), {}, 5}).status, TrackerStatus::stale);
  EXPECT_EQ(tracker.update({scan.view(), {}, 4.5}).status, TrackerStatus::stale);
  EXPECT_EQ(tracker.update({scan.view(), {}, 1}).status, TrackerStatus::ok) << "the clock was set back";
  EXPECT_EQ(tracker.update({{}, {}, 1.1}).status, TrackerStatus::bad_scan);
}

TEST(ObjectTrackerInput, AStampMayGoBackByMoreThanASecond) {
  ObjectTracker tracker;
  EXPECT_EQ(tracker.update({{}, {}, 10}).status, TrackerStatus::bad_scan);
  EXPECT_EQ(tracker.update({{}, {}, 9.2}).status, TrackerStatus::stale);
  EXPECT_EQ(tracker.update({{}, {}, 8.5}).status, TrackerStatus::bad_scan) << "a clock that was set back";
}

TEST(AllocationFailure, ATrackerAndAPredictorAreMadeOrThrow) {
  const maps::OccupancyGrid map = room();
  const std::vector<maps::ReferencePoint> path = course();
  EXPECT_GT(testing::fail_every_allocation([&] { return ObjectTracker(map).options().max_objects; }), 5);
  EXPECT_GT(testing::fail_every_allocation([&] { return ObjectTracker().options().max_objects; }), 5);
  EXPECT_GT(testing::fail_every_allocation([&] { return Predictor(path).update({}, 0).size(); }), 3);
}

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

}  // namespace
}  // namespace slalom::tracking::tracking_parts_test
