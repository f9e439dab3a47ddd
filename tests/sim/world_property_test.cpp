#include <gtest/gtest.h>

#include "sim/rooms.hpp"
#include "slalom/sim/pure_pursuit.hpp"
#include "slalom/sim/world.hpp"
#include "support/allocations.hpp"

namespace slalom::sim {
namespace {

const std::array two_cars{maps::Pose{15.5, 10, 1.57}, maps::Pose{10, 15.5, 3.14}};
const std::array parked{maps::Pose{4.5, 10, 0.3}, maps::Pose{10, 4.2, 1.3}};

/// Commands that wander, hit things at times, and are the same for the same step.
std::array<Command, 2> wander(std::int64_t k) {
  const double t = 0.01 * k;
  return {Command{0.17 + 0.2 * std::sin(3 * t), 2 + std::sin(t)}, Command{0.18 * std::cos(0.3 * t), 1.5}};
}

TEST(WorldProperty, StepsDoNotAllocate) {
  for (const bool gym : {false, true}) {
    WorldOptions options = gym ? WorldOptions::gym_compatible() : WorldOptions{};
    if (!gym) options.wall_response = options.body_response = CollisionResponse::slide;
    World world(options, testing::ring_track());
    world.reset(3, two_cars, parked);
    world.step(wander(0));
    const long before = testing::allocations();
    bool collided = false;
    for (int k = 1; k < 1500; ++k) {
      world.step(wander(k));
      collided = collided || world.observe(0).collides() || world.observe(1).collides();
    }
    EXPECT_EQ(testing::allocations(), before);
    EXPECT_TRUE(collided);
  }
}

TEST(WorldProperty, CarsHaveNoiseOfTheirOwn) {
  World world({}, std::make_shared<const Track>(testing::room(200, 200)));
  world.reset(3, std::array{maps::Pose{3, 5, 0}, maps::Pose{3, 7, 0}});
  std::vector<float> clean(world.lidar().padded_beams());
  std::array<std::vector<float>, 2> noise;
  for (std::size_t car = 0; car < 2; ++car) {
    const Observation seen = world.observe(car);
    world.lidar().scan(world.track(), seen.sensor, clean);
    for (std::size_t i = 400; i < 700; ++i) noise[car].push_back(seen.scan.ranges[i] - clean[i]);
  }
  EXPECT_NE(noise[0], noise[1]);
}

/// A car of each model.
class EveryModel : public ::testing::TestWithParam<Model> {
 protected:
  EveryModel() { options_.dynamics.model = GetParam(); }
  PlantOptions options_;
};
INSTANTIATE_TEST_SUITE_P(Models, EveryModel,
                         ::testing::Values(Model::kinematic, Model::single_track, Model::saturating));

TEST_P(EveryModel, MirroredInputsGiveMirroredMotion) {
  Plant left({}, options_, 0.01), right({}, options_, 0.01);
  left.reset({.yaw = 0.4});
  right.reset({.yaw = -0.4});
  for (int k = 0; k < 400; ++k) {
    const double steer = 0.3 * std::sin(0.05 * k), speed = 3 + 2 * std::sin(0.02 * k);
    left.step({steer, speed});
    right.step({-steer, speed});
    ASSERT_NEAR(left.state().x, right.state().x, 1e-9);
    ASSERT_NEAR(left.state().y, -right.state().y, 1e-9);
    ASSERT_NEAR(left.state().slip, -right.state().slip, 1e-9);
  }
  EXPECT_GT(left.state().speed, 1);
}

TEST_P(EveryModel, MotionDoesNotDependOnTheStartPose) {
  Plant a({}, options_, 0.01), b({}, options_, 0.01);
  const maps::Pose moved{3, -4, 1.1};
  a.reset({});
  b.reset({.x = moved.x, .y = moved.y, .yaw = moved.yaw});
  for (int k = 0; k < 300; ++k) {
    const Command command{0.25 * std::sin(0.03 * k), 4};
    a.step(command);
    b.step(command);
  }
  const maps::Point expected = maps::transform(moved, {a.state().x, a.state().y});
  EXPECT_NEAR(b.state().x, expected.x, 1e-9);
  EXPECT_NEAR(b.state().y, expected.y, 1e-9);
}

TEST_P(EveryModel, ACoastingCarGainsNoEnergy) {
  Plant plant({}, options_, 0.01);
  const CarParameters car;
  plant.reset({.steer = 0.2, .speed = 6});
  const auto energy = [&] {
    const CarState& s = plant.state();
    return 0.5 * car.mass * s.speed * s.speed + 0.5 * car.inertia * s.yaw_rate * s.yaw_rate;
  };
  // The linear model has no drag in turns: its speed stays; the yaw rate has to build up first.
  double last = 0.5 * car.mass * 36;
  for (int k = 0; k < 300; ++k) {
    plant.coast();
    ASSERT_LE(plant.state().speed, 6 + 1e-9);
    if (GetParam() == Model::saturating) {
      ASSERT_LE(energy(), last + 1e-3);
      last = energy();
    }
  }
  EXPECT_TRUE(GetParam() != Model::saturating || plant.state().speed < 5.9);
}

TEST_P(EveryModel, ReversingIsStable) {
  Plant plant({}, options_, 0.01);
  plant.reset({});
  for (int k = 0; k < 500; ++k) plant.step({0.1, -2});
  EXPECT_NEAR(plant.state().speed, -2, 0.1);
  // A circle: yaw rate about v tan(steer) / L, turning right while backing with the wheels to the left.
  EXPECT_NEAR(plant.state().yaw_rate, -2 * std::tan(0.1) / 0.3302, 0.15);
  EXPECT_LT(std::abs(plant.state().slip), 0.15);
}

TEST(WorldProperty, GripCanBeExceeded) {
  PlantOptions options{.dynamics = {.model = Model::saturating}};
  Plant plant({}, options, 0.01);
  plant.reset({.speed = 8});
  double most = 0;
  for (int k = 0; k < 100; ++k) {
    plant.step({0.35, plant.state().speed});
    most = std::max(most, std::abs(plant.state().yaw_rate * plant.state().speed));
  }
  // Sideways acceleration beyond mu g is not to be had for long; linear tyres would give 71 m/s^2.
  EXPECT_LT(std::abs(plant.state().yaw_rate * plant.state().speed), 1.3 * 1.0489 * 9.81);
}

TEST(WorldProperty, FullScaleCarIsStable) {
  PlantOptions options;
  Plant plant(CarParameters::full_scale(), options, 0.01);
  plant.reset({});
  for (int k = 0; k < 1000; ++k) {
    plant.step({0.05, 10});
    ASSERT_LT(std::abs(plant.state().slip), 0.5);
    ASSERT_LT(std::abs(plant.state().yaw_rate), 1.0);
  }
  EXPECT_NEAR(plant.state().speed, 10, 0.5);
}

}  // namespace
}  // namespace slalom::sim
