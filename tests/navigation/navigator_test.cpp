#include "slalom/navigation/navigator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "navigation/drive.hpp"
#include "navigation/navigator_calls.hpp"
#include "slalom/core/random.hpp"
#include "slalom/navigation/path_planner.hpp"
#include "support/allocation_failures.hpp"
#include "support/allocations.hpp"
#include "support/thrown_words.hpp"

namespace slalom::navigation::navigator_test {
namespace {

const Footprint body = Footprint::rectangle(0.35, 0.35, 0.5);

/// A robot in 10 x 4 m around (5, 0), whose commands are checked.
struct CheckedDrive : Drive {
  explicit CheckedDrive(const NavigatorOptions& given = {}, int threads = 1)
      : Drive(given, free_grid(0, -2, 10, 4)) {
    pose = {1, 0, 0};
    restart_fast(threads);
  }
  NavigationResult step() {
    const Velocity before = velocity;
    const NavigationResult result = update();
    const Velocity& v = result.command;
    const BaseOptions& base = options.base;
    EXPECT_LE(v.forward, base.max_forward + 1e-6);
    EXPECT_GE(v.forward, -base.max_reverse - 1e-6);
    EXPECT_LE(std::abs(v.turn), base.max_turn + 1e-6);
    EXPECT_LE(std::abs(v.forward - before.forward), base.max_acceleration * period + 1e-6);
    EXPECT_LE(std::abs(v.turn - before.turn), base.max_turn_acceleration * period + 1e-6);
    EXPECT_TRUE(v.left == 0 || base.kind == BaseKind::omnidirectional);
    return result;
  }
};

const maps::Pose straight[] = {{1, 0, 0}, {6, 0, 0}};

TEST(Navigator, PassesAPalletOnThePathWithoutChangingItsSide) {
  CheckedDrive drive;
  drive.block(3, -0.6, 4, 0.6);  // as near to one side as to the other
  drive.navigator->set_path(straight);
  RandomStream random({1, 0});
  int side = 0;
  NavigationStatus status = NavigationStatus::following;
  for (double time = 0; time < 30 && status != NavigationStatus::goal_reached; time += period) {
    const maps::OccupancyGrid seen = drive.grid;  // the edges of what was seen flicker
    for (int i = 0; i < 6; ++i)
      fill(drive.grid, 3, random.uniform() < 0.5 ? 0.6 : -0.67, 4, random.uniform() < 0.5 ? 0.67 : -0.6);
    drive.costmap.update(drive.grid);
    const NavigationResult result = drive.step();
    status = result.status;
    drive.grid = seen;
    for (const maps::Pose& pose : result.path) {
      if (std::abs(pose.x - 3.5) > 0.03) continue;
      const int here = pose.y > 0 ? 1 : -1;
      EXPECT_TRUE(side == 0 || here == side) << time;
      side = here;
    }
  }
  EXPECT_EQ(status, NavigationStatus::goal_reached);
  EXPECT_NE(side, 0);
  EXPECT_FALSE(drive.collided);
}

/// Drives on a square costmap around the robot until the goal is reached or the way is blocked.
NavigationStatus drive_with_a_moving_costmap(CheckedDrive& drive, double side, double x0, double y0,
                                             double x1, double y1) {
  NavigationStatus status = NavigationStatus::following;
  maps::OccupancyGrid seen = free_grid(0, 0, side, side);
  drive.costmap = Costmap(seen.width, seen.height, seen.resolution);
  drive.restart_fast();
  const maps::Pose path[] = {{1, 0, 0}, {9, 0, 0}};
  drive.navigator->set_path(path);
  for (int i = 0; i < 800 && status != NavigationStatus::goal_reached && status != NavigationStatus::blocked;
       ++i) {
    seen = free_grid(std::floor(drive.pose.x / 0.05) * 0.05 - side / 2,
                     std::floor(drive.pose.y / 0.05) * 0.05 - side / 2, side, side);
    fill(seen, x0, y0, x1, y1);
    drive.costmap.update(seen);
    status = drive.step().status;
  }
  EXPECT_FALSE(drive.collided);
  return status;
}

// At first the costmap shows where the pallet begins and not where it ends.
TEST(Navigator, ADetourMayEndAtTheEdgeOfTheCostmap) {
  for (const double side : {6.0, 3.0}) {
    CheckedDrive drive;
    EXPECT_EQ(drive_with_a_moving_costmap(drive, side, 4.5, -0.8, 5.5, 0.9), NavigationStatus::goal_reached);
  }
}

TEST(Navigator, IsBlockedByAWallThatIsLongerThanTheCostmapShows) {
  CheckedDrive drive;
  EXPECT_EQ(drive_with_a_moving_costmap(drive, 6, 4.5, -20, 5.5, 20), NavigationStatus::blocked);
  EXPECT_LT(drive.pose.x, 4.5 - 0.35);
}

TEST(Navigator, ASearchOverALargeCostmapTakesSeveralUpdates) {
  CheckedDrive drive;
  drive.grid = free_grid(0, 0, 40, 40);  // 640,000 cells
  drive.costmap = Costmap(drive.grid.width, drive.grid.height, drive.grid.resolution);
  drive.block(20, 0, 20.3, 38);
  drive.restart_fast();
  drive.start({16, 19, 0}, {{16, 19, 0}, {24, 19, 0}});
  int updates = 0;
  while (updates < 100 && drive.step().status == NavigationStatus::following) ++updates;
  EXPECT_EQ(drive.step().status, NavigationStatus::detour);
  EXPECT_GT(updates, 10);
  EXPECT_LT(updates, 40);
  EXPECT_FALSE(drive.collided);
}

TEST(Navigator, WithoutDetoursItReportsNone) {
  CheckedDrive drive({.find_detours = false});
  drive.block(4, -2, 4.3, 2);
  drive.navigator->set_path(straight);
  for (int i = 0; i < 200; ++i) {
    const NavigationResult result = drive.step();
    EXPECT_NE(result.status, NavigationStatus::detour);
    EXPECT_NE(result.status, NavigationStatus::blocked);
    EXPECT_NEAR(result.path.back().x, 6, 1e-9);
  }
  EXPECT_FALSE(drive.collided);
}

TEST(Navigator, BrakesWhereEveryPlanMeetsAnObstacle) {
  CheckedDrive drive;
  drive.navigator->set_path(straight);
  drive.drive(2);
  EXPECT_EQ(drive.step().status, NavigationStatus::following);
  const double front = drive.pose.x + 0.35, speed = drive.velocity.forward;
  drive.block(front + 0.06, -2, front + 0.5, 2);  // at once
  EXPECT_EQ(drive.step().status, NavigationStatus::braking);
  EXPECT_NEAR(drive.velocity.forward, speed - period * drive.options.base.max_acceleration, 1e-6);
}

TEST(Navigator, StandsWhereItCannotDrive) {
  CheckedDrive drive;
  EXPECT_EQ(drive.step().status, NavigationStatus::no_path);
  drive.navigator->set_path(straight);
  drive.velocity = {0.5, 0, 0.3};
  const double nan = std::nan("");
  const Costmap other(50, 50, 0.05);
  const auto update = [&](const maps::Pose& pose, const Velocity& velocity, const Costmap& costmap,
                          double elapsed) {
    return drive.navigator->update(pose, velocity, costmap, elapsed);
  };
  EXPECT_EQ(update({nan, 0, 0}, drive.velocity, drive.costmap, period).status, NavigationStatus::bad_input);
  EXPECT_EQ(update(drive.pose, {nan, 0, 0}, drive.costmap, period).status, NavigationStatus::bad_input);
  for (const double speed : {101.0, -4132.0, 1e300}) {  // no robot has
    const NavigationResult result = update(drive.pose, {speed, 0, 0}, drive.costmap, period);
    EXPECT_EQ(result.status, NavigationStatus::bad_input) << speed;
    EXPECT_EQ(result.command.forward, 0) << speed;
  }
  EXPECT_EQ(update(drive.pose, drive.velocity, drive.costmap, -1).status, NavigationStatus::bad_input);
  EXPECT_EQ(update(drive.pose, drive.velocity, drive.costmap, nan).status, NavigationStatus::bad_input);
  EXPECT_EQ(update(drive.pose, drive.velocity, other, period).status, NavigationStatus::bad_input);
  EXPECT_EQ(update({-5, 0, 0}, drive.velocity, drive.costmap, period).status, NavigationStatus::no_path);
  const Velocity braking = update({nan, 0, 0}, drive.velocity, drive.costmap, period).command;
  EXPECT_NEAR(braking.forward, 0.5 - period * drive.options.base.max_acceleration, 1e-9);
  EXPECT_NEAR(braking.turn, 0.3 - period * drive.options.base.max_turn_acceleration, 1e-9);
  EXPECT_EQ(drive.step().status, NavigationStatus::following);
}

TEST(Navigator, RejectsInvalidOptionsAndPaths) {
  NavigatorOptions options;
  options.base.max_forward = -1;
  const Costmap costmap(50, 50, 0.05);
  EXPECT_THROW(Navigator(body, options, costmap), std::invalid_argument);
  EXPECT_NO_THROW(Navigator(Footprint::rectangle(20, 20, 1), {}, costmap)) << "any length";
  Navigator navigator(body, {}, costmap);
  EXPECT_THROW(navigator.set_path({}), std::invalid_argument);
  const maps::Pose path[] = {{0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}};
  EXPECT_THROW(navigator.set_path(path), std::invalid_argument);
  const maps::Pose apart[] = {{0, 0, 0}, {1e6, 0, 0}};
  EXPECT_EQ(message_of([&] { navigator.set_path(apart); }),
            "path: 1000400 m in steps of 0.05 m must be at most 10500 m, 210000 steps");
}

TEST(Navigator, ACopyDrivesOnLikeTheOriginalAndAllocatesNothing) {
  CheckedDrive drive;
  drive.block(3, -0.6, 4, 0.7);
  drive.navigator->set_path(straight);
  Navigator copy = *drive.navigator;
  NavigationStatus status = NavigationStatus::following;
  for (int i = 0; i < 40; ++i) {
    if (i == 10) copy = *drive.navigator;
    const long before = testing::allocations();
    const Velocity of_copy = copy.update(drive.pose, drive.velocity, drive.costmap, period).command;
    const auto of_original = drive.navigator->update(drive.pose, drive.velocity, drive.costmap, period);
    EXPECT_EQ(testing::allocations(), before);
    status = of_original.status;
    drive.move(of_original);
    ASSERT_EQ(of_copy.forward, of_original.command.forward) << i;
    ASSERT_EQ(of_copy.turn, of_original.command.turn) << i;
  }
  EXPECT_EQ(status, NavigationStatus::detour);
}

TEST(Navigator, TheSameSeedGivesTheSameCommandsOnAnyNumberOfThreads) {
  CheckedDrive one({}, 1), three({}, 3);
  for (CheckedDrive* drive : {&one, &three}) {
    drive->block(3, -0.6, 4, 0.7);
    drive->navigator->set_path(straight);
  }
  for (int i = 0; i < 30; ++i) {
    const Velocity a = one.step().command, b = three.step().command;
    ASSERT_EQ(a.forward, b.forward);
    ASSERT_EQ(a.turn, b.turn);
  }
  const maps::Pose end = one.pose;
  one.pose = {1, 0, 0};
  one.velocity = {};
  one.navigator->reset(0);
  one.navigator->set_path(straight);
  for (int i = 0; i < 30; ++i) one.step();
  EXPECT_EQ(one.pose.x, end.x);
  EXPECT_EQ(one.pose.yaw, end.yaw);
}

TEST(MethodOptions, ScaleWithTheLimitsOfTheBase) {
  BaseOptions base{.max_forward = 2, .max_turn = 3};
  const SolverOptions cem = method_options("cem", base), sv_mpc = method_options("sv_mpc", base);
  EXPECT_STREQ(cem.method(), "cem");
  EXPECT_EQ(*cem.find<int>("horizon"), 56);
  EXPECT_NEAR((*cem.find<PerInput>("variance"))[0], 0.64, 1e-12);
  EXPECT_NEAR((*cem.find<PerInput>("variance"))[1], 0.36, 1e-12);
  EXPECT_NEAR((*sv_mpc.find<PerInput>("gradient_variance"))[1], 0.09, 1e-12);
  EXPECT_EQ(*sv_mpc.find<double>("temperature"), 0.1);
  // As many rollouts in a solve as svg_mppi makes, so that the method keeps the control period.
  const SvgMppiOptions usual = svg_mppi_options(base);
  const int rollouts =
      usual.samples + usual.guides.count * usual.guides.iterations * usual.guides.gradient_samples;
  EXPECT_EQ(*method_options("mppi", base).find<int>("samples"), rollouts);
  EXPECT_LE(
      *sv_mpc.find<int>("samples") * *sv_mpc.find<int>("iterations") * *sv_mpc.find<int>("gradient_samples"),
      rollouts);
  EXPECT_TRUE(method_options("svg_mppi", base).get_if<SvgMppiOptions>());
  EXPECT_THROW(method_options("dwa", base), std::invalid_argument);
}

TEST(NavigatorCheck, ALongPathWithManyCornersIsTakenInAnUpdate) {
  const Hall hall;
  Navigator navigator = make_navigator({}, hall.costmap);
  std::vector<maps::Pose> zigzag{{-1.5, 0, 0}};  // 3 km
  for (int i = 0; i < 15000; ++i) zigzag.push_back({0.1 * i, i % 2 * 0.17, 0});
  navigator.set_path(zigzag);
  const testing::CallLimits limits;
  EXPECT_EQ(navigator.update({-1.5, 0, 0}, {}, hall.costmap, period).status, NavigationStatus::detour);
  EXPECT_NO_THROW(limits.check(5));
}

TEST(NavigatorCheck, BrakesToTheLimitsOfTheBase) {
  const Hall hall;
  const NavigatorOptions options;
  Navigator navigator = make_navigator(options, hall.costmap);
  const NavigationResult result =
      navigator.update({-1.5, 0, 0}, {.forward = 4, .left = 1, .turn = -9}, hall.costmap, period);
  EXPECT_EQ(result.status, NavigationStatus::no_path);
  EXPECT_EQ(result.command.forward, 4 - period * options.base.max_acceleration);
  EXPECT_EQ(result.command.left, 0) << "a differential base does not move sideways";
  EXPECT_EQ(result.command.turn, -9 + period * options.base.max_turn_acceleration);
  EXPECT_EQ(result.corrections, 1);
  navigator.update({-1.5, 0, 0}, {}, hall.costmap, period);
  EXPECT_LE(navigator.update({-1.5, 0, 0}, {.forward = 4}, hall.costmap, period).command.forward,
            options.base.max_forward)
      << "once is an error of the odometry";
}

TEST(AllocationFailure, ANavigatorIsMadeAndTakesAPathOrThrows) {
  const Hall hall;
  EXPECT_GT(testing::fail_every_allocation([&] {
              Navigator navigator = make_navigator({}, hall.costmap);
              navigator.set_path(std::vector<maps::Pose>{{-1.5, 0, 0}, {1.5, 0, 0}});
              return navigator.update({-1.5, 0, 0}, {}, hall.costmap, period).command.forward;
            }),
            20);
}

}  // namespace
}  // namespace slalom::navigation::navigator_test
