#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "sim/rooms.hpp"
#include "slalom/sim/placement.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(PurePursuit, StaysNearThePathAndReturnsToIt) {
  std::vector<PathPoint> path;
  for (const maps::Point& p : testing::circle(5.5)) path.push_back({p, 2});
  const PurePursuit driver(path);
  World world({}, testing::ring_track());
  world.reset(1, std::array{maps::Pose{16.2, 10, 1.2}});
  for (int k = 0; k < 2500; ++k) {
    world.step(std::array{driver.command(world.observe(0).pose)});
    ASSERT_FALSE(world.observe(0).collides());
    if (k > 500) {
      ASSERT_LT(std::abs(world.laps(0)->lateral()), 0.15);
    }
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

}  // namespace
}  // namespace slalom::sim
