#include <gtest/gtest.h>

#include <cstdio>

#include "navigation/navigator_calls.hpp"
#include "support/adversarial_tries.hpp"
#include "support/allocation_failures.hpp"

/// Every command of a navigator is a velocity that the base may have, whatever its inputs.
namespace slalom::navigation {
namespace {

const maps::Pose path[] = {{-1.5, 0, 0}, {1.5, 0, 0}};

TEST(NavigatorCheck, IgnoresAVelocityThatNoRobotHas) {
  const Hall hall;
  Navigator navigator = make_navigator({}, hall.costmap);
  navigator.set_path(path);
  for (const double speed : {101.0, -4132.0, 1e300}) {
    const NavigationResult result = navigator.update({-1.5, 0, 0}, {.forward = speed}, hall.costmap, period);
    EXPECT_EQ(result.status, NavigationStatus::bad_input) << speed;
    EXPECT_EQ(result.command.forward, 0) << speed;
  }
}

TEST(NavigatorCheck, BrakesWithinTheLimitsOfTheBase) {
  const Hall hall;
  const NavigatorOptions options;
  Navigator navigator = make_navigator(options, hall.costmap);
  const NavigationResult result =
      navigator.update({-1.5, 0, 0}, {.forward = 4, .left = 1, .turn = -9}, hall.costmap, period);
  EXPECT_EQ(result.status, NavigationStatus::no_path);
  EXPECT_EQ(result.command.forward, options.base.max_forward);
  EXPECT_EQ(result.command.left, 0) << "a differential base does not move sideways";
  EXPECT_EQ(result.command.turn, -options.base.max_turn);
  EXPECT_EQ(result.corrections, 3);
}

TEST(NavigatorCheck, EveryCommandIsValidForAnyInput) {
  const Hall hall;
  NavigatorTally tally;
  testing::try_adversaries(
      testing::repetitions(1000), tally.updates,
      [&](testing::Adversary& adversary, std::uint64_t) { call_navigator(adversary, hall, tally); });
  std::printf("[ calls    ] %ld updates, %ld corrections;", tally.updates, tally.corrections);
  for (int i = 0; i < 10; ++i)
    std::printf(" %s %ld", name(static_cast<NavigationStatus>(i)), tally.statuses[i]);
  std::printf("\n");
  for (const NavigationStatus status : {NavigationStatus::following, NavigationStatus::braking,
                                        NavigationStatus::no_path, NavigationStatus::bad_input})
    EXPECT_GT(tally.statuses[static_cast<int>(status)], 0) << name(status);
}

TEST(AllocationFailure, ANavigatorIsMadeAndTakesAPathOrThrows) {
  const Hall hall;
  EXPECT_GT(testing::fail_every_allocation([&] {
              Navigator navigator = make_navigator({}, hall.costmap);
              navigator.set_path(path);
              return navigator.update({-1.5, 0, 0}, {}, hall.costmap, period).command.forward;
            }),
            20);
}

}  // namespace
}  // namespace slalom::navigation
