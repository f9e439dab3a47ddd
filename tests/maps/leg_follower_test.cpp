// The ends of legs, and the commands along them.
#include "slalom/maps/leg_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace slalom::maps::leg_follower_test {
namespace {

constexpr double period = 0.025;
const LegOptions small_car = LegOptions::of(0.58, 1.3);

/// A floor with a wall across at x = wall, m, as a vehicle at a pose sees it.
class Floor final : public BodyRoom {
 public:
  double at(const Pose& pose) const noexcept override {
    return wall - transform(vehicle, {pose.x, pose.y}).x;
  }
  Pose vehicle;
  double wall = std::numeric_limits<double>::infinity();
};

/// A path 1.5 m forward, and 1 m back on an arc.
PathCurve with_a_cusp() {
  std::vector<Pose> poses;
  for (double x = 0; x < 1.5; x += 0.1) poses.push_back({x, 0, 0});
  for (double angle = 0; angle < 1; angle += 0.1)
    poses.push_back({1.5 - std::sin(angle), 1 - std::cos(angle), -angle});
  PathCurve path;
  path.reserve(100);
  path.set(poses, false);
  return path;
}

TEST(LegFollower, StopsAtACuspAndDrivesBackToTheEnd) {
  PathCurve path = with_a_cusp();
  LegFollower follower(small_car);
  Floor floor;
  Pose& pose = floor.vehicle;
  double speed = 0, furthest = 0, fastest = 0, slowest = 0, at_cusp = 1;
  follower.begin(pose);
  int k = 0;
  for (; k < 1000; ++k) {
    follower.update(path, pose, {speed}, period, [] { return 0.0; });
    if (path.on_last_leg() && follower.is_finished(path, pose)) break;
    if (at_cusp == 1 && path.on_last_leg()) at_cusp = std::abs(speed);
    const auto command = follower.command(path, pose, speed, 0, floor);
    ASSERT_TRUE(command);
    speed += std::clamp(command->speed - speed, -2 * period, 2 * period);
    const double turned = speed * period * command->curvature, middle = pose.yaw + 0.5 * turned;
    pose = {pose.x + speed * period * std::cos(middle), pose.y + speed * period * std::sin(middle),
            pose.yaw + turned};
    furthest = std::max(furthest, pose.x);
    fastest = std::max(fastest, speed);
    slowest = std::min(slowest, speed);
  }
  EXPECT_LT(k, 1000);
  EXPECT_NEAR(furthest, 1.5, 0.06);
  EXPECT_LT(at_cusp, 0.08);
  EXPECT_NEAR(fastest, 0.8, 0.02);
  EXPECT_NEAR(slowest, -0.5, 0.02);
  EXPECT_NEAR(pose.x, 1.5 - std::sin(0.95), 0.08);
  EXPECT_NEAR(pose.y, 1 - std::cos(0.95), 0.08);
}

TEST(LegFollower, BrakesWithItsOwnDeceleration) {
  PathCurve path = with_a_cusp();
  LegFollower follower(small_car);
  path.place({1.3, 0});
  follower.begin({1.3, 0, 0});
  follower.update(path, {1.3, 0, 0}, {0.5}, period, [] { return 0.0; });
  const auto command = follower.command(path, {1.3, 0, 0}, 0.5, 0, Floor());
  ASSERT_TRUE(command);
  EXPECT_NEAR(command->speed, std::sqrt(2 * 1.2 * 0.2) + 0.06, 0.02);
}

TEST(LegFollower, HasNoCommandBesideTheLegOrWhereAnObstacleIsOnIt) {
  PathCurve path = with_a_cusp();
  LegFollower follower(small_car);
  follower.begin({});
  Floor floor;
  EXPECT_TRUE(follower.command(path, {0, 0.14, 0}, 0, 0, floor));
  EXPECT_FALSE(follower.command(path, {0, 0.16, 0}, 0, 0, floor));
  floor.wall = 1.495;
  EXPECT_TRUE(follower.command(path, {}, 0, 0, floor)) << "5 mm";
  floor.wall = 1.45;
  EXPECT_FALSE(follower.command(path, {}, 0, 0, floor));
}

TEST(LegFollower, ALegEndsWhereTheVehicleHasComeToRestNearItsEnd) {
  LegOptions robot = small_car;
  robot.stops = false;
  for (const double away : {0.03, 0.1, 0.18, 0.25}) {
    PathCurve path = with_a_cusp();
    LegFollower follower(robot);
    const Pose pose{1.5 - away, 0, 0};
    follower.begin(pose);
    int k = 0;
    for (; k < 100 && !path.on_last_leg(); ++k) follower.update(path, pose, {}, period, [] { return 0.0; });
    EXPECT_NEAR(k * period,
                away < 0.04   ? period
                : away < 0.15 ? 0.5
                : away < 0.2  ? 1
                              : 2.5,
                2.1 * period)
        << away;
  }
}

TEST(LegFollower, ATurnOnTheSpotEndsNearItsYaw) {
  const Pose poses[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 1.57}};
  PathCurve path;
  path.reserve(100);
  path.set(poses, true);
  LegFollower follower(small_car);
  follower.begin({});
  Pose pose{1, 0, 0};
  for (; pose.yaw < 1.5 && !path.on_last_leg(); pose.yaw += 0.02) {
    follower.update(path, pose, {0, 0.8}, period, [&] { return path.leg().turns ? 1.57 : 0; });
    if (path.leg().turns) {
      EXPECT_NEAR(follower.turn_left(), 1.57 - pose.yaw, 1e-9);
    }
  }
  EXPECT_NEAR(pose.yaw, 1.38, 0.05);
}

}  // namespace
}  // namespace slalom::maps::leg_follower_test
