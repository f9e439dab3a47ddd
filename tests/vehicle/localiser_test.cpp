#include "slalom/vehicle/localisation/localiser.hpp"

#include <algorithm>

#include "support/thrown_words.hpp"
#include "vehicle/localiser_drive.hpp"

namespace slalom::vehicle::localiser_test {
namespace {

using test::Drive;
using test::error_of;
using test::PreparedCourse;
using test::wren;

/// A room with a notch, so that no two poses look alike.
maps::OccupancyGrid room() {
  maps::OccupancyGrid map{120, 80, 0.05, {-1, -2, 0.3}, {}};
  map.cells.assign(120 * 80, maps::Occupancy::free);
  for (int x = 0; x < 120; ++x)
    for (int y = 0; y < 80; ++y)
      if (x < 2 || y < 2 || x >= 118 || y >= 78 || (x > 80 && y > 50))
        map.at(x, y) = maps::Occupancy::occupied;
  return map;
}

TEST(LocaliserConstruction, RejectsInvalidMaps) {
  const auto with = [](const maps::OccupancyGrid& map) { return message_of([&] { Localiser{map}; }); };
  maps::OccupancyGrid map = room();
  std::fill(map.cells.begin(), map.cells.end(), maps::Occupancy::occupied);
  EXPECT_NE(with(map).find("free cell"), std::string::npos);
  std::fill(map.cells.begin(), map.cells.end(), maps::Occupancy::free);
  EXPECT_NE(with(map).find("occupied cell"), std::string::npos);
  map = room();
  map.cells.pop_back();
  EXPECT_NE(with(map).find("width x height"), std::string::npos);
  map = room();
  map.resolution = 0;
  EXPECT_NE(with(map).find("resolution"), std::string::npos);
  map = room();
  map.origin.x = NAN;
  EXPECT_NE(with(map).find("origin"), std::string::npos);
}

/// A course of 340 m around a field, free inside and outside of its walls, as maps of racetracks are drawn.
Course free_outside() {
  Course course;
  constexpr int side = 900;
  course.map = {side, side, 0.1, {}, std::vector<maps::Occupancy>(std::size_t{side} * side)};
  for (const int away : {20, 30})  // cells from the border: two square walls
    for (int i = away; i < side - away; ++i)
      for (const auto& [x, y] : {std::pair{i, away}, {i, side - 1 - away}, {away, i}, {side - 1 - away, i}})
        course.map.at(x, y) = maps::Occupancy::occupied;
  const double near = 2.5, far = 87.5;  // m, between the walls
  for (const maps::Point& point : {maps::Point{near, near}, {far, near}, {far, far}, {near, far}})
    course.waypoints.push_back({point.x, point.y, 0, 5});
  complete_course(course, true);
  return course;
}

TEST(Localiser, UsesTheLikelihoodFieldOnAMapThatIsTooLargeForATable) {
  const Course course = free_outside();
  EXPECT_EQ(Localiser(course.map).options().sensor_model, SensorModel::likelihood_field);
  const Localiser inside(reachable_map(course));
  EXPECT_EQ(inside.options().sensor_model, SensorModel::beam) << "of the space between the walls";
}

TEST(Localiser, FindsAStandingCarInARotatedMap) {
  const maps::OccupancyGrid map = room();
  const sim::Track track(map);
  const sim::Lidar lidar({.beams = 361, .field_of_view = 4.7, .range_max = 20, .mount = {0.275, 0, 0}});
  const maps::Point where = maps::transform(map.origin, {2.1, 1.2});
  const maps::Pose pose{where.x, where.y, 1.1};
  std::vector<float> ranges(lidar.padded_beams());
  lidar.scan(track, lidar.sensor_pose(pose), ranges);
  const maps::LaserScanView scan{{ranges.data(), 361}, -2.35, 4.7 / 360, 0, 20};
  for (const SensorModel model : {SensorModel::beam, SensorModel::likelihood_field}) {
    Localiser localiser(map, {.sensor_model = model});
    localiser.start_at({pose.x + 0.3, pose.y - 0.2, pose.yaw + 0.1});
    for (int i = 0; i < 20; ++i) localiser.update({scan, {5, 6, 7}, 0.1 * i});
    const LocaliserOutput& out = localiser.output();
    EXPECT_EQ(out.status, LocaliserStatus::ok);
    EXPECT_LT(error_of(out.pose, pose).distance, 0.1);
    // The truth is within 4 standard deviations, and 5 cm or a degree and a half for the map's cells.
    EXPECT_LT(error_of(out.pose, pose).yaw, 4 * std::sqrt(out.covariance[2][2]) + 0.026);
    EXPECT_GT(out.health, 0.9);
    EXPECT_LT(std::abs(out.pose.x - pose.x), 4 * std::sqrt(out.covariance[0][0]) + 0.05);
    EXPECT_LT(std::abs(out.pose.y - pose.y), 4 * std::sqrt(out.covariance[1][1]) + 0.05);
    EXPECT_NEAR(out.covariance[0][1], out.covariance[1][0], 1e-12);
    // The odometry's frame is where the odometry says what the estimate is.
    const maps::Pose frame = localiser.odometry_frame();
    const maps::Point back = maps::transform(frame, {5, 6});
    EXPECT_NEAR(back.x, out.pose.x, 1e-9);
    EXPECT_NEAR(back.y, out.pose.y, 1e-9);
  }
}

// Several places of a course look alike. The particles that fit the first scan best may all be in a wrong
// one, so the localiser searches before it is sure. One of six places may look like another within the noise.
TEST(Localiser, SearchesBeforeItIsSureOfAnUnknownStart) {
  int wrong = 0;
  for (const char* name : {"fox", "wren"}) {
    const PreparedCourse prepared(name);
    Localiser localiser(prepared.course.map);
    for (const double share : {0.0, 0.3, 0.6}) {
      localiser.start_everywhere();
      const Drive standing(prepared, prepared.at(share), 1);
      LocaliserInput input = standing.input();
      bool sure = false, sure_elsewhere = false;
      for (int i = 1; i <= 110; ++i) {
        input.stamp = i * Drive::period;
        const LocaliserOutput& out = localiser.update(input);
        if (out.status != LocaliserStatus::ok) continue;
        sure = true;
        sure_elsewhere = sure_elsewhere || error_of(out.pose, standing.truth()).distance > 0.3;
      }
      EXPECT_TRUE(sure) << name << " " << share;
      wrong += sure_elsewhere;
    }
  }
  EXPECT_LE(wrong, 1);
}

// Other cars hide most walls from a standing car: the poor fit does not mean that it is elsewhere.
TEST(Localiser, IsSureAgainBehindWhatHidesTheWallsOnceNoOtherPlaceIsBetter) {
  Localiser localiser(wren().course.map);
  Drive drive(wren(), wren().at(0.2), 3);
  localiser.start_at(drive.truth());
  for (int i = 0; i < 40; ++i, drive.step()) localiser.update(drive.input());
  for (std::size_t i = 0; i < 600; ++i) drive.ranges()[i] = std::min(drive.ranges()[i], 0.4F);
  LocaliserInput input = drive.input();
  int unsure = 0, sure = 0;
  for (int i = 0; i < 240; ++i, input.stamp += Drive::period) {
    const LocaliserOutput& out = localiser.update(input);
    (i < 80 ? unsure : sure) += (out.status == LocaliserStatus::ok) == (i >= 80);
    EXPECT_LT(error_of(out.pose, drive.truth()).distance, 0.3) << i;
  }
  EXPECT_GT(unsure, 20);
  EXPECT_GT(sure, 100);
}

TEST(Localiser, ResetEqualsConstruction) {
  Localiser used(room(), {.seed = 1}), fresh(room(), {.seed = 9});
  Drive drive(wren(), wren().at(0.2), 3);
  for (int i = 0; i < 5; ++i, drive.step()) used.update(drive.input());
  used.reset(9);
  Drive other(wren(), wren().at(0.5), 4);
  for (int i = 0; i < 5; ++i, other.step()) {
    used.update(other.input());
    fresh.update(other.input());
    EXPECT_EQ(used.output().pose.x, fresh.output().pose.x);
    EXPECT_EQ(used.output().particles, fresh.output().particles);
  }
}

TEST(Localiser, TakesFewerParticlesOnceItIsSure) {
  Localiser localiser(wren().course.map, {.min_particles = 300, .max_particles = 4000});
  Drive drive(wren(), wren().at(0.2), 3);
  EXPECT_EQ(localiser.particle_count(), 4000);
  localiser.start_at(drive.truth());
  for (int i = 0; i < 40; ++i, drive.step()) localiser.update(drive.input());
  EXPECT_LT(localiser.particle_count(), 1000);
  double sum = 0;
  for (int i = 0; i < localiser.particle_count(); ++i) sum += localiser.particle(i).weight;
  EXPECT_NEAR(sum, 1, 1e-6);
}

}  // namespace
}  // namespace slalom::vehicle::localiser_test
