#include "slalom/sim/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/rooms.hpp"
#include "slalom/sim/pure_pursuit.hpp"

namespace slalom::sim::world_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const std::array start{maps::Pose{15.5, 10, 1.5707963}};

/// A room of 20 x 5 m.
std::shared_ptr<const Track> hall() {
  return std::make_shared<const Track>(testing::room(400, 100));
}

TEST(World, DrivesLapsWithTimes) {
  World world({}, testing::ring_track());
  world.reset(1, start);
  const PurePursuit driver(testing::ring_path(3));
  CollisionLog contacts;
  while (world.laps(0)->laps() < 2 && world.time() < 60) {
    world.step(std::array{driver.command(world.observe(0).pose)});
    contacts.update(world, 0);
  }
  EXPECT_EQ(world.laps(0)->laps(), 2);
  EXPECT_EQ(contacts.collisions(), 0);
  // 34.6 m at 3 m/s.
  EXPECT_NEAR(world.laps(0)->last_lap_time(), 2 * 3.141592653589793 * 5.5 / 3, 0.6);
}

TEST(World, DrivingBackwardsIsNoLap) {
  World world({}, testing::ring_track());
  world.reset(1, std::array{maps::Pose{15.5, 10, -1.5707963}});
  std::vector<PathPoint> reversed = testing::ring_path(2);
  std::reverse(reversed.begin(), reversed.end());
  const PurePursuit driver(reversed);
  for (int i = 0; i < 3000; ++i) world.step(std::array{driver.command(world.observe(0).pose)});
  EXPECT_EQ(world.laps(0)->laps(), 0);
  EXPECT_LT(world.laps(0)->progress(), -40);
}

TEST(World, FollowsStatesThatAreKnown) {
  World world({.time_step = 0.05}, testing::ring_track());
  world.reset(1, start);
  const double step = 0.02;  // rad of the ring
  for (int i = 1; i <= 320; ++i) {
    const double at = step * i;
    const CarState state{
        .x = 10 + 5.5 * std::cos(at), .y = 10 + 5.5 * std::sin(at), .speed = 2.2, .yaw = at + 1.5708};
    world.follow(std::array{state});
    EXPECT_EQ(world.state(0), state);
    EXPECT_FALSE(world.observe(0).wall);
  }
  EXPECT_EQ(world.laps(0)->laps(), 1);
  EXPECT_NEAR(world.laps(0)->last_lap_time(), 0.05 * 2 * 3.141592653589793 / step, 0.1);
  EXPECT_NEAR(world.time(), 16, 1e-9);
  world.follow(std::array{CarState{.x = 10 + 7.0, .y = 10}});  // in the outer wall, and it stays there
  EXPECT_TRUE(world.observe(0).wall);
  EXPECT_EQ(world.state(0).x, 17.0);
  EXPECT_THROW(world.follow(std::array{CarState{.x = nan}}), std::invalid_argument);
  EXPECT_THROW(world.follow({}), std::invalid_argument);
}

TEST(World, MovingACarIsNoProgress) {
  World world({}, testing::ring_track());
  world.reset(1, start);
  world.set_state(0, {.x = 4.5, .y = 10, .yaw = -1.5707963});
  world.step(std::array{Command{0, 1}});
  EXPECT_NEAR(world.laps(0)->progress(), 0, 0.05);
  EXPECT_NEAR(world.laps(0)->arc(), 5.5 * 3.14159, 0.1);
  EXPECT_THROW(world.set_state(1, {}), std::out_of_range);
}

TEST(World, StopsAtWallsAndReversesAway) {
  World world({}, testing::ring_track());
  world.reset(1, std::array{maps::Pose{15.5, 10, 0}});
  CollisionLog contacts;
  for (int i = 0; i < 300; ++i) {
    world.step(std::array{Command{0, 4}});
    contacts.update(world, 0);
    ASSERT_FALSE(world.track().collides_with_wall(world.outline(0)));
  }
  EXPECT_TRUE(contacts.hit_wall());
  EXPECT_EQ(contacts.collisions(), 1);
  EXPECT_EQ(contacts.flag_patterns(), 1);
  // The nose stands at the wall, 7 m from the middle of the ring.
  EXPECT_NEAR(world.state(0).x + 0.29, 17, 0.1);
  for (int i = 0; i < 100; ++i) world.step(std::array{Command{0, -1}});
  EXPECT_FALSE(world.observe(0).collides());
  EXPECT_LT(world.state(0).x, 16.4);
}

TEST(World, SlidesAlongWalls) {
  World world({.wall_response = CollisionResponse::slide}, hall());
  world.reset(1, std::array{maps::Pose{2, 4, 0.5}});
  bool collided = false;
  for (int i = 0; i < 400; ++i) {
    world.step(std::array{Command{0, 3}});
    collided = collided || world.observe(0).wall;
    ASSERT_FALSE(world.track().collides_with_wall(world.outline(0)));
  }
  EXPECT_TRUE(collided);
  EXPECT_GT(world.state(0).x, 5);
}

TEST(World, ReportsWhichBodiesCollide) {
  constexpr CollisionResponse none = CollisionResponse::count_only;
  World world({.wall_response = none, .body_response = none}, hall());
  const std::array parked{maps::Pose{4, 2.5, 1.2}, maps::Pose{8, 2.6, 0}, maps::Pose{8.3, 2.6, 0}};
  world.reset(1, std::array{maps::Pose{1, 2.5, 0}}, parked);
  const int disc = world.add_disc({{11, 2.5}, 0.2});
  const int box = world.add_box({{13, 2.7, 0.3}, 0.4, 0.4});
  CollisionLog contacts;
  while (world.time() < 5) {
    world.step(std::array{Command{0, 5}});
    contacts.update(world, 0);
  }
  EXPECT_EQ(std::vector<int>(contacts.bodies().begin(), contacts.bodies().end()),
            (std::vector{1, 2, 3, disc, box}));
  EXPECT_TRUE(contacts.hit_wall());
  EXPECT_EQ(contacts.collisions(), 6);
  // Bodies 2 and 3 overlap and are flagged for ever, with and without the others: {2,3}, +1, +disc, +box.
  EXPECT_EQ(contacts.flag_patterns(), 4);
}

/// Two cars in a room, the first of which drives into the second from behind, or the other way round.
World bump(CollisionResponse response, bool first_is_behind) {
  World world({.body_response = response}, std::make_shared<const Track>(testing::room(600, 100)));
  const maps::Pose behind{2, 2.5, 0}, ahead{3, 2.5, 0};
  world.reset(1, first_is_behind ? std::array{behind, ahead} : std::array{ahead, behind});
  const Command fast{0, 4}, slow{0, 2};
  while (world.time() < 5) {
    world.step(first_is_behind ? std::array{fast, slow} : std::array{slow, fast});
    if (!world.observe(0).colliding.empty()) break;
  }
  EXPECT_EQ(world.observe(0).colliding.size(), 1U);
  return world;
}

TEST(World, ACarThatIsStruckKeepsItsMotionWhicheverItIs) {
  for (const bool first_is_behind : {true, false}) {
    const World world = bump(CollisionResponse::slide_unless_struck, first_is_behind);
    const std::size_t behind = first_is_behind ? 0 : 1, ahead = 1 - behind;
    EXPECT_GT(world.state(ahead).speed, 1.5);
    EXPECT_LT(world.state(behind).speed, 3) << "of about 4 m/s";
    EXPECT_GT(signed_gap(world.outline(0), world.outline(1)), 0) << "they are apart after the step";
  }
  EXPECT_EQ(bump(CollisionResponse::slide, false).state(0).speed, 0) << "with slide the first car stops";
}

TEST(World, ACarThatIsTakenAwayIsNoLongerThere) {
  World world({.lidar = {.noise = 0}}, hall());
  const std::array cars{maps::Pose{2, 2.5, 0}, maps::Pose{5, 2.5, 0}};
  world.reset(1, cars);
  const std::size_t ahead = 540;
  EXPECT_LT(world.observe(0).scan.ranges[ahead], 3);
  world.take_away(1);
  EXPECT_TRUE(world.on_track(0));
  EXPECT_FALSE(world.on_track(1));
  const std::vector<float> last(world.observe(1).scan.ranges.begin(), world.observe(1).scan.ranges.end());
  while (world.time() < 3) {
    world.step(std::array{Command{0, 3}, Command{0, 3}});
    EXPECT_FALSE(world.observe(0).collides() || world.observe(1).collides());
  }
  EXPECT_GT(world.state(0).x, 8) << "through the place of the other one";
  EXPECT_EQ(world.state(1).x, 5) << "it takes no commands";
  EXPECT_TRUE(std::equal(last.begin(), last.end(), world.observe(1).scan.ranges.begin()))
      << "nor does it scan";
  EXPECT_THROW(world.take_away(2), std::out_of_range);
  world.reset(1, cars);
  EXPECT_TRUE(world.on_track(1));
}

TEST(World, SeesBodiesWhereTheyAre) {
  World world({.lidar = {.noise = 0}}, hall());
  world.reset(1, std::array{maps::Pose{2, 2.5, 0}, maps::Pose{12, 2.5, 0}},
              std::array{maps::Pose{5, 2.5, 0}});
  const std::size_t ahead = 540;
  const double sensor = 2 + world.options().lidar.mount.x;
  EXPECT_NEAR(world.observe(0).scan.ranges[ahead], 5 - 0.29 - sensor, 1e-4);
  world.move_body(2, {8, 4, 0});
  world.step(std::array{Command{}, Command{}});
  EXPECT_NEAR(world.observe(0).scan.ranges[ahead], 12 - 0.29 - sensor, 1e-4);
  world.add_disc({{4, 2.5}, 0.1});
  world.step(std::array{Command{}, Command{}});
  EXPECT_NEAR(world.observe(0).scan.ranges[ahead], 4 - 0.1 - sensor, 1e-4);
  // The second car looks at the far wall, whose inner face is one cell short of 20 m.
  EXPECT_NEAR(world.observe(1).scan.ranges[ahead], 19.95 - 12 - world.options().lidar.mount.x, 1e-3);
}

TEST(World, BodiesCanBeRemoved) {
  World world({.lidar = {.noise = 0}}, hall());
  world.reset(1, std::array{maps::Pose{2, 2.5, 0}}, std::array{maps::Pose{5, 2.5, 0}, maps::Pose{8, 2.5, 0}});
  const int disc = world.add_disc({{3, 2.5}, 0.1});
  EXPECT_THROW(world.remove_body(0), std::invalid_argument);
  EXPECT_THROW(world.remove_body(disc + 1), std::invalid_argument);
  world.remove_body(1);
  ASSERT_EQ(world.bodies(), 3u);
  EXPECT_EQ(world.outline(1).pose.x, 8);
  EXPECT_TRUE(world.disc(2));
  world.remove_body(2);
  world.step(std::array{Command{}});
  EXPECT_NEAR(world.observe(0).scan.ranges[540], 8 - 0.29 - 2 - world.options().lidar.mount.x, 1e-4);
}

TEST(World, LidarRateHoldsScans) {
  World world({.lidar = {.rate = 40}}, testing::ring_track());
  world.reset(1, start);
  std::vector<double> times;
  for (int i = 0; i < 10; ++i) {
    world.step(std::array{Command{0, 1}});
    times.push_back(world.observe(0).scan_time);
  }
  const std::vector<double> expected{0, 0, 0.03, 0.03, 0.03, 0.06, 0.06, 0.06, 0.09, 0.09};
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], expected[i], 1e-12) << i;
}

TEST(World, CoastsWithoutACommand) {
  World world({}, std::make_shared<const Track>(testing::room(800, 100)));
  world.reset(1, std::array{maps::Pose{2, 2.5, 0}});
  for (int i = 0; i < 100; ++i) EXPECT_EQ(world.step(std::array{Command{0, 2}}), StepStatus::ok);
  const double before = world.state(0).speed;
  for (int i = 0; i < 50; ++i) EXPECT_EQ(world.step({}), StepStatus::missing_command);
  EXPECT_DOUBLE_EQ(world.state(0).speed, before);
  const CarState held = world.state(0);
  EXPECT_EQ(world.step(std::array{Command{nan, 2}}), StepStatus::non_finite_command);
  EXPECT_EQ(world.step(std::array{Command{0, std::numeric_limits<double>::infinity()}}),
            StepStatus::non_finite_command);
  EXPECT_GT(world.state(0).x, held.x);
}

TEST(World, RejectsInvalidStarts) {
  World world({}, testing::ring_track());
  EXPECT_THROW(world.reset(1, std::array{maps::Pose{10, 10, 0}}), std::invalid_argument);
  EXPECT_THROW(world.reset(1, std::array{maps::Pose{16.9, 10, 0}}), std::invalid_argument);
  EXPECT_THROW(world.reset(1, std::array{maps::Pose{-50, 10, 0}}), std::invalid_argument);
  for (const maps::Pose& far : {maps::Pose{nan, 10, 0}, {1e8, 10, 0}, {15, 10, 1e7}}) {
    EXPECT_THROW(world.reset(1, std::array{far}), std::invalid_argument);
    EXPECT_THROW(world.reset(1, start, std::array{far}), std::invalid_argument);
    EXPECT_THROW(world.move_body(1, far), std::invalid_argument);
  }
  EXPECT_THROW(world.reset(1, std::array{start[0], start[0]}), std::invalid_argument);
  EXPECT_THROW(world.reset(1, start, start), std::invalid_argument);
  EXPECT_NO_THROW(world.reset(1, start));
  EXPECT_THROW(world.add_disc({{12, 12}, 0}), std::invalid_argument);
  EXPECT_THROW(world.add_disc({{12, 12}, -1}), std::invalid_argument);
  EXPECT_THROW(world.add_box({{12, nan, 0}, 1, 1}), std::invalid_argument);
  EXPECT_THROW(world.move_body(0, {}), std::invalid_argument);
  EXPECT_THROW(world.move_body(1, {}), std::invalid_argument);
}

TEST(Track, RejectsInvalidMaps) {
  const auto refuses = [](auto change) {
    maps::OccupancyGrid grid = testing::room(10, 10);
    change(grid);
    EXPECT_THROW(Track{grid}, std::invalid_argument);
  };
  refuses([](auto& grid) { grid.width = 0; });
  refuses([](auto& grid) { grid.height = -3; });
  for (const double resolution : {0.0, nan}) refuses([&](auto& grid) { grid.resolution = resolution; });
  refuses([](auto& grid) { grid.origin.yaw = nan; });
  refuses([](auto& grid) { grid.cells.pop_back(); });
  refuses([](auto& grid) { grid.cells.assign(grid.cells.size(), maps::Occupancy::occupied); });
  EXPECT_THROW(LapPath({{0, 0}, {1, 0}}), std::invalid_argument);
  EXPECT_THROW(LapPath({{0, 0}, {1, 0}, {nan, 1}}), std::invalid_argument);
  EXPECT_THROW(LapPath({{1, 1}, {1, 1}, {1, 1}}), std::invalid_argument);
}

TEST(LapPath, PlacesACarOnThePartThatItDrivesAlong) {
  std::vector<maps::Point> eight;
  for (double t = 0; t < 6.28; t += 0.04) eight.push_back({10 * std::sin(t), 4 * std::sin(2 * t)});
  const LapPath path(eight);
  for (const double arc : {0.1, 0.5 * path.length() + 0.1}) {
    const maps::Pose on = path.at(arc);
    const maps::Point aside = maps::transform(on, {0, 0.3});
    EXPECT_NEAR(path.project({aside.x, aside.y, on.yaw - 0.3}).arc, arc, 0.2);
  }
}

}  // namespace
}  // namespace slalom::sim::world_test
