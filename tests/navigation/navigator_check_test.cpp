#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "navigation/grids.hpp"
#include "slalom/navigation/navigator.hpp"
#include "support/adversary.hpp"
#include "support/allocation_failures.hpp"
#include "support/any_others.hpp"
#include "support/promise.hpp"
#include "support/repetitions.hpp"

/// Every command of a navigator is a velocity that the base may have, whatever its inputs.
namespace slalom::navigation {
namespace {

constexpr double period = 0.05;  // s

SvgMppiOptions few_samples(const BaseOptions& base) {
  SvgMppiOptions solver = svg_mppi_options(base);
  solver.horizon = 8;
  solver.samples = 32;
  solver.guides.iterations = 1;
  return solver;
}

/// 4 m x 4 m around the origin with a box in it.
struct Hall {
  Hall() : grid(free_grid(-2, -2, 4, 4)), costmap(grid.width, grid.height, grid.resolution) {
    fill(grid, 0.5, -0.5, 1, 0.5);
    costmap.update(grid);
  }
  maps::OccupancyGrid grid;
  Costmap costmap;
};

Navigator make_navigator(const NavigatorOptions& options, const Costmap& costmap) {
  return {Footprint::rectangle(0.3, 0.3, 0.4), options, few_samples(options.base), costmap};
}

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

/// Throws Finding unless a base with these limits may be sent this.
void check(const NavigationResult& result, const BaseOptions& base) {
  using testing::require;
  const Velocity& v = result.command;
  require(v.forward >= -base.max_reverse && v.forward <= base.max_forward, "the speed is within its limits");
  require(std::abs(v.left) <= (base.kind == BaseKind::omnidirectional ? base.max_sideways : 0),
          "the sideways speed is within its limits");
  require(std::abs(v.turn) <= base.max_turn, "the yaw rate is within its limits");
  require(std::isfinite(result.remaining), "the remaining path is finite");
  for (const maps::Pose& each : result.plan)
    require(std::isfinite(each.x) && std::isfinite(each.y) && std::isfinite(each.yaw), "plans are finite");
  for (const maps::Pose& each : result.path)
    require(std::isfinite(each.x) && std::isfinite(each.y), "the path is finite");
}

struct Tally {
  long updates = 0, corrections = 0;
  long statuses[7] = {};
};

/// One navigator and a few dozen updates. Throws Finding.
void call_navigator(testing::Adversary& adversary, const Hall& hall, Tally& tally) {
  NavigatorOptions options;
  options.base.kind = static_cast<BaseKind>(adversary.below(3));
  options.find_detours = adversary.below(4) != 0;
  options.patience = adversary.within(0, 1);
  options.stuck_after = adversary.within(0.1, 2);
  if (adversary.below(2)) options.time_step = adversary.within(0.001, 1);
  Navigator navigator = make_navigator(options, hall.costmap);
  const Costmap other_size(10, 10, 0.1);
  testing::AnyOthers others;
  for (int i = 0; i < 60; ++i) {
    const bool hostile = adversary.once_in(4);
    const auto value = [&](double low, double high) {
      return hostile ? adversary.any(low, high) : adversary.within(low, high);
    };
    if (adversary.once_in(10)) {
      const maps::Pose points[] = {{value(-2, 2), value(-2, 2), 0},
                                   {value(-2, 2), value(-2, 2), value(-4, 4)}};
      try {
        navigator.set_path(points);
      } catch (const std::invalid_argument&) {  // not finite, or too far away
      }
    }
    if (adversary.once_in(40)) navigator.reset(static_cast<std::uint64_t>(i));
    const maps::Pose pose{value(-2, 2), value(-2, 2), value(-4, 4)};
    const Velocity velocity{value(-1, 1), value(-1, 1), value(-2, 2)};
    const Costmap& costmap = adversary.once_in(20) ? other_size : hall.costmap;
    const NavigationResult result =
        navigator.update(pose, velocity, costmap, value(0, 0.2), others.draw(adversary));
    check(result, options.base);
    ++tally.updates;
    ++tally.statuses[static_cast<int>(result.status)];
    tally.corrections += result.corrections;
  }
}

TEST(NavigatorCheck, EveryCommandIsValidForAnyInput) {
  const long calls = testing::repetitions(1000);
  const Hall hall;
  Tally tally;
  for (std::uint64_t seed = testing::first_seed(); tally.updates < calls; ++seed) {
    testing::Adversary adversary(seed);
    try {
      call_navigator(adversary, hall, tally);
    } catch (const testing::Finding& finding) {
      FAIL() << "seed " << seed << ": " << finding.what();
    }
  }
  std::printf("[ calls    ] %ld updates, %ld corrections;", tally.updates, tally.corrections);
  for (int i = 0; i < 7; ++i)
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
