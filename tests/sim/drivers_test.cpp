#include <gtest/gtest.h>

#include "sim/rooms.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/racing_opponent.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim::drivers_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(PurePursuit, StaysNearThePathAndReturnsToIt) {
  const PurePursuit driver(testing::ring_path(2));
  World world({}, testing::ring_track());
  world.reset(1, std::array{maps::Pose{16.2, 10, 1.2}});
  for (int k = 0; k < 2500; ++k) {
    world.step(std::array{driver.command(world.observe(0).pose)});
    ASSERT_FALSE(world.observe(0).collides());
    ASSERT_TRUE(k <= 500 || std::abs(world.laps(0)->offset()) < 0.15) << world.laps(0)->offset();
  }
  EXPECT_EQ(world.laps(0)->laps(), 1);
}

TEST(PurePursuit, RejectsInvalidInput) {
  EXPECT_THROW(PurePursuit({{{0, 0}, 1}, {{1, 0}, 1}}), std::invalid_argument);
  EXPECT_THROW(PurePursuit({{{0, 0}, 1}, {{1, nan}, 1}, {{1, 1}, 1}}), std::invalid_argument);
  EXPECT_THROW(PurePursuit({{{0, 0}, 1}, {{1, 0}, 1}, {{1, 1}, 1}}, {.lookahead = 0}), std::invalid_argument);
}

TEST(ObstaclePlacement, ApartCarsDoNotOverlapAndLeaveTheStart) {
  const auto path = testing::circle(5.5);
  const auto track = testing::ring_track();
  std::vector<double> room;
  for (const maps::Point& p : path) room.push_back(track->distance_to_wall(p));
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const maps::Point start{15.5, 10};
    const auto cars = place_apart(path, room, 5, seed, start);
    ASSERT_EQ(cars.size(), 5u);
    for (std::size_t i = 0; i < cars.size(); ++i) {
      const Box box{cars[i], CarParameters{}.length, CarParameters{}.width};
      EXPECT_FALSE(track->collides_with_wall(box));
      EXPECT_GT(std::hypot(cars[i].x - start.x, cars[i].y - start.y), 3);
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GT(signed_gap(box, Box{cars[j], box.length, box.width}), 0.75);
    }
  }
  EXPECT_THROW(place_apart(path, room, 500, 1, {15.5, 10}), std::runtime_error);
  EXPECT_THROW(place_apart({}, {}, 1, 1, {}), std::invalid_argument);
  EXPECT_THROW(place_at_random({}, 1, 1), std::invalid_argument);
  EXPECT_THROW(place_at_random(path, -1, 1), std::invalid_argument);
}

constexpr double radius = 5.5;

/// A car that drives to the left round the ring.
maps::Pose on_ring(double angle, double outward = 0) {
  return testing::on_ring(angle, radius + outward);
}

std::vector<Box> boxes(const std::vector<maps::Pose>& poses) {
  const CarParameters car;
  std::vector<Box> made;
  for (const maps::Pose& pose : poses) made.push_back({pose, car.length, car.width});
  return made;
}

/// The line for cars that drive at this speed among what is parked.
std::shared_ptr<const RacingLine> line(double speed, const std::vector<maps::Pose>& parked = {}) {
  return std::make_shared<const RacingLine>(testing::ring_path(speed), *testing::ring_track(),
                                            CarParameters{}, boxes(parked));
}

/// Drives for a time (s) with a decision every 0.02 s; steps with a collision of any car.
int drive(World& world, std::vector<RacingOpponent>& drivers, double time) {
  int collisions = 0;
  std::vector<Command> commands(drivers.size());
  const double end = world.time() + time;
  for (int k = 0; world.time() < end; ++k) {
    for (std::size_t i = 0; i < drivers.size() && k % 2 == 0; ++i) commands[i] = drivers[i].command(world);
    world.step(commands);
    for (std::size_t i = 0; i < drivers.size(); ++i) collisions += world.observe(i).collides();
  }
  return collisions;
}

World world_of(const std::vector<maps::Pose>& cars, const std::vector<maps::Pose>& parked = {}) {
  World world({}, testing::ring_track());
  world.reset(1, cars, parked);
  return world;
}

TEST(RacingLine, LeadsRoundWhatIsParkedWithItsMargins) {
  const std::vector<maps::Pose> parked = {on_ring(1), on_ring(2.5, 0.4), on_ring(4, -0.3)};
  const auto alone = line(3), among = line(3, parked);
  const CarParameters car;
  double widest = 0;
  for (double arc = 0; arc < among->path().length(); arc += 0.1) {
    const RacingLine::Point at = among->at(arc);
    EXPECT_NEAR(alone->at(arc).offset, 0, 1e-9);
    EXPECT_GE(at.offset, at.least);
    EXPECT_LE(at.offset, at.most);
    EXPECT_LE(at.speed, 3);
    const Box body{{at.point.x - at.offset * std::sin(at.yaw), at.point.y + at.offset * std::cos(at.yaw),
                    at.yaw + std::atan((among->at(arc + 0.1).offset - at.offset) / 0.1)},
                   car.length,
                   car.width};
    for (const Box& box : boxes(parked)) EXPECT_GT(signed_gap(body, box), 0.05) << arc;
    widest = std::max(widest, std::abs(at.offset));
  }
  EXPECT_GT(widest, 0.3);
  EXPECT_LT(widest, 1);
}

TEST(RacingLine, WhereNothingIsFreeItStaysOnThePath) {
  std::vector<maps::Pose> wall;
  for (double outward = -1.6; outward <= 1.6; outward += 0.25) wall.push_back(on_ring(2, outward));
  const auto closed = line(3, wall);
  EXPECT_EQ(closed->at(0).offset, 0);
}

TEST(RacingLine, LeadsRoundWhatIsLongerThanACar) {
  const std::vector<Box> wall{{on_ring(2, 0.6), 6, 0.3}};  // its middle is 0.6 m outside of the path
  const RacingLine among(testing::ring_path(3), *testing::ring_track(), CarParameters{}, wall);
  const CarParameters car;
  for (double arc = 0; arc < among.path().length(); arc += 0.1) {
    const RacingLine::Point at = among.at(arc);
    const maps::Point middle = at.beside(at.offset);
    EXPECT_GT(signed_gap({{middle.x, middle.y, at.yaw}, car.length, car.width}, wall[0]), 0.05) << arc;
  }
}

TEST(RacingOpponent, AvoidsWhatPurePursuitDrivesInto) {
  const std::vector<maps::Pose> cars = {on_ring(0), on_ring(3.1)};
  const std::vector<maps::Pose> parked = {on_ring(1), on_ring(2.5, 0.3), on_ring(4.5, -0.3)};
  World world = world_of(cars, parked);
  std::vector<RacingOpponent> drivers;
  for (std::size_t i = 0; i < 2; ++i)
    drivers.emplace_back(line(4, parked), i, OpponentDriver::racing, 0.9, RandomKey{1, i});
  EXPECT_EQ(drive(world, drivers, 25), 0);
  EXPECT_GE(world.laps(0)->laps(), 2);
  EXPECT_GE(world.laps(1)->laps(), 2);

  World blind = world_of(cars, parked);
  const PurePursuit pursuit(testing::ring_path(3.6));
  bool collided = false;
  while (blind.time() < 5) {
    blind.step(std::array{pursuit.command(blind.observe(0).pose), pursuit.command(blind.observe(1).pose)});
    collided = collided || blind.observe(0).collides();
  }
  EXPECT_TRUE(collided);
}

TEST(RacingOpponent, FollowsASlowerCarWithoutTouchingIt) {
  World world = world_of({on_ring(0), on_ring(0.6)});
  std::vector<RacingOpponent> drivers;
  drivers.emplace_back(line(4), 0, OpponentDriver::racing, 0.9, RandomKey{1, 0});
  drivers.emplace_back(line(4), 1, OpponentDriver::racing, 0.4, RandomKey{1, 1});
  EXPECT_EQ(drive(world, drivers, 15), 0);
  EXPECT_LT(world.laps(0)->progress(), world.laps(1)->progress() + 0.6 * radius);
  EXPECT_GT(world.laps(0)->progress(), world.laps(1)->progress() + 0.6 * radius - 2.5);
}

TEST(RacingOpponent, StopsBehindACarThatStandsInItsLane) {
  // With 0.6 m, and with 0.1 m between the cars; the sum of their half lengths is 0.58 m.
  for (const double apart : {1.2, 0.68}) {
    World world = world_of({on_ring(0), on_ring(apart / radius)});
    RacingOpponent driver(line(4), 0, OpponentDriver::racing, 1, RandomKey{1, 0});
    while (world.time() < 4) {
      world.step(std::array{driver.command(world), Command{}});
      ASSERT_FALSE(world.observe(0).collides()) << apart << " m, after " << world.time() << " s";
    }
    EXPECT_NEAR(world.state(0).speed, 0, 0.01);
  }
}

TEST(RacingOpponent, LeavesRoomToACarAlongside) {
  const auto line_here = line(4);
  const double path_yaw = on_ring(0).yaw;
  World world = world_of({on_ring(0, 0.5), on_ring(0)});
  RacingOpponent outer(line_here, 0, OpponentDriver::racing, 1, RandomKey{1, 0}),
      inner(line_here, 1, OpponentDriver::racing, 1, RandomKey{1, 1});
  double nearest = 10;
  for (int k = 0; world.time() < 3; ++k) {
    world.step(std::array{outer.command(world), inner.command(world)});
    ASSERT_FALSE(world.observe(0).collides());
    const double turned = std::abs(maps::wrap_angle(world.state(0).yaw - path_yaw));
    if (turned < 0.5) nearest = std::min(nearest, signed_gap(world.outline(0), world.outline(1)));
  }
  EXPECT_GT(nearest, 0.08);
}

TEST(RacingOpponent, BlocksTheCarBehindWithinItsLimitsAndNotOneAlongside) {
  const auto lane_with = [&](double behind, double outward) {
    RacingOpponent driver(line(4), 1, OpponentDriver::blocking, 1, RandomKey{1, 1});
    World world = world_of({on_ring(1 - behind / radius, outward), on_ring(1)});
    CarState moving = world.state(0);
    moving.speed = 3;
    world.set_state(0, moving);
    driver.command(world);
    return driver.lane();
  };
  EXPECT_NEAR(lane_with(2, 0.4), -0.4, 0.1) << "outward is to the right";
  EXPECT_NEAR(lane_with(2, -0.4), 0.4, 0.1);
  EXPECT_EQ(lane_with(2, 1.2), -0.6);
  EXPECT_EQ(lane_with(6, 0.4), 0) << "out of reach";
  EXPECT_EQ(lane_with(0.3, 0.6), 0) << "alongside";
}

TEST(RacingOpponent, DrawsLanesAndSpeedsFromItsKeyAlone) {
  const auto driven = [](std::uint64_t seed) {
    World world = world_of({on_ring(0)});
    std::vector<RacingOpponent> drivers;
    drivers.emplace_back(line(4), 0, OpponentDriver::erratic, 1, RandomKey{seed, 0});
    double least = 0, most = 0;
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(drive(world, drivers, 0.2), 0);
      least = std::min(least, world.laps(0)->offset());
      most = std::max(most, world.laps(0)->offset());
    }
    EXPECT_LT(least, -0.1);
    EXPECT_GT(most, 0.1);
    return world.state(0);
  };
  EXPECT_EQ(driven(3), driven(3));
  EXPECT_FALSE(driven(3) == driven(4));
}

TEST(RacingOpponent, RejectsInvalidInput) {
  const std::vector<PathPoint> far{{{0, 0}, 1}, {{1e9, 0}, 1}, {{0, 1e9}, 1}};
  EXPECT_THROW(RacingLine(far, *testing::ring_track(), {}), std::invalid_argument);
  EXPECT_THROW(RacingOpponent(line(4), 0, OpponentDriver::racing, 1.1, RandomKey{}), std::invalid_argument);
  EXPECT_THROW(RacingOpponent(nullptr, 0, OpponentDriver::racing, 1, RandomKey{}), std::invalid_argument);
  EXPECT_THROW(
      RacingLine(testing::ring_path(std::numeric_limits<double>::quiet_NaN()), *testing::ring_track(), {}),
      std::invalid_argument);
}

}  // namespace
}  // namespace slalom::sim::drivers_test
