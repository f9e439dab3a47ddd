// A tracker with an estimated pose keeps its place while the localiser is uncertain, from the first scan on,
// and where the localiser is sure of a wrong one.
#include "evaluation/tracking/tracking_meter.hpp"

#include <gtest/gtest.h>

#include "slalom/vehicle/localisation/localiser.hpp"

namespace slalom::evaluation {
namespace {

constexpr int scans = 200;
constexpr double period = 0.025;  // s
constexpr maps::Pose start{-3, -1.5, 0};

/// The three cars about the start: to the left, to the right and across in front. They hide most of the room.
std::array<maps::Pose, 3> cars_about_the_start(double sensor_x) {
  return {{{sensor_x, start.y + 0.55, 0},
           {sensor_x, start.y - 0.55, 0},
           {sensor_x + 0.75, start.y, 0.5 * std::numbers::pi}}};
}

/// A rectangular room, the same after half a turn about (0, 0), but for three pillars of the size of the
/// cars. Seen from the start turned by half a turn about (0, 0), they look as the cars look from the start.
maps::OccupancyGrid room_with_the_same_view_elsewhere(const sim::CarParameters& car, double sensor_x) {
  maps::OccupancyGrid map{
      .width = 320, .height = 200, .resolution = 0.05, .origin = {-8, -5, 0}, .cells = {}};
  map.cells.assign(static_cast<std::size_t>(map.width * map.height), maps::Occupancy::free);
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      bool occupied = row < 2 || column < 2 || row >= map.height - 2 || column >= map.width - 2;
      const maps::Point turned{-(map.origin.x + (column + 0.5) * map.resolution),
                               -(map.origin.y + (row + 0.5) * map.resolution)};
      for (const maps::Pose& pose : cars_about_the_start(sensor_x)) {
        const maps::Point in_car = maps::inverse_transform(pose, turned);
        occupied |= std::abs(in_car.x) <= 0.5 * car.length && std::abs(in_car.y) <= 0.5 * car.width;
      }
      if (occupied) map.at(column, row) = maps::Occupancy::occupied;
    }
  }
  return map;
}

TEST(TrackingMeter, ATrackerKeepsItsPlaceWhereTheLocaliserJumps) {
  sim::WorldOptions options{.time_step = period};
  options.lidar.noise = 0.02;
  const sim::CarParameters& car = options.car;
  const maps::Pose mount{car.rear_length + options.lidar.mount.x, options.lidar.mount.y, 0};
  const double sensor_x = start.x + options.lidar.mount.x;
  const maps::OccupancyGrid map = room_with_the_same_view_elsewhere(car, sensor_x);
  const auto track = std::make_shared<const sim::Track>(map);

  constexpr std::uint64_t seed = 1;
  sim::World world(options, track);
  world.reset(seed, std::array{start}, cars_about_the_start(sensor_x));
  TrackingMeter meter(TrackingMode::localised, map, world, 0, seed);
  // The same localiser as that of the meter, to see that it jumps.
  const maps::Pose rear_axle = sim::rear_axle(car, world.state(0));
  vehicle::Localiser localiser(
      map, vehicle::LocaliserOptions{.seed = seed, .laser_x = mount.x, .laser_y = mount.y});
  localiser.start_at(rear_axle);
  int sure_elsewhere = 0;
  for (int i = 0; i < scans; ++i) {
    const sim::Observation seen = world.observe(0);
    meter.observe(world, seen.scan);
    const vehicle::LocaliserOutput& out = localiser.update({seen.scan, {}, seen.time});
    sure_elsewhere += out.status == vehicle::LocaliserStatus::ok &&
                      std::hypot(out.pose.x - rear_axle.x, out.pose.y - rear_axle.y) > 3;
    world.step(std::array{Command{}});
    meter.moved(world.state(0), period);
  }
  EXPECT_GT(sure_elsewhere, scans / 4);
  const TrackingRecord record = meter.record();
  EXPECT_EQ(record.in_view, 3 * scans);
  // At the localiser's pose the cars are pillars of the map: no object.
  EXPECT_GT(record.long_detected, 0.9 * record.long_in_view);
}

}  // namespace
}  // namespace slalom::evaluation
