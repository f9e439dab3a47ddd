// The poses of sensors, stamps, and the file with the last pose.
#include "logic/transforms.hpp"

#include "logic/known_pose.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::nodes::transforms_test {
namespace {

constexpr double quarter = std::numbers::pi / 2;  // rad

void expect_pose(const maps::Pose& pose, double x, double y, double yaw) {
  EXPECT_NEAR(pose.x, x, 1e-12);
  EXPECT_NEAR(pose.y, y, 1e-12);
  EXPECT_NEAR(pose.yaw, yaw, 1e-12);
}

TEST(Mount, OfAnUprightSensorIsAPoseInThePlane) {
  const Mount turned = mount_of(0.3, -0.1, 0.2, 0, 0, std::sin(quarter / 2), std::cos(quarter / 2));
  EXPECT_TRUE(turned.upright());
  expect_pose(turned.planar(), 0.3, -0.1, quarter);
  const double ahead_of_sensor[3] = {2, 0, 0}, up[3] = {0, 0, 3};
  EXPECT_NEAR(along(0, turned, ahead_of_sensor), 0, 1e-12);
  EXPECT_NEAR(along(1, turned, ahead_of_sensor), 2, 1e-12) << "it looks to the left of the car";
  EXPECT_NEAR(along(2, turned, up), 3, 1e-12);
}

TEST(Mount, OfASensorThatHangsUpsideDownIsNotUpright) {
  const Mount hanging = mount_of(0, 0, 0, 1, 0, 0, 0);  // turned by 180 degrees about x
  EXPECT_FALSE(hanging.upright());
  const double left[3] = {0, 1, 0}, up[3] = {0, 0, 3};
  EXPECT_NEAR(along(1, hanging, left), -1, 1e-12) << "its left is the right of the car";
  EXPECT_NEAR(along(2, hanging, up), -3, 1e-12);
}

TEST(StampTest, SurvivesTheWayThroughSeconds) {
  const Stamp stamp = 1'700'000'000'250'000'000;
  EXPECT_NEAR(static_cast<double>(stamp_of(in_seconds(stamp)) - stamp), 0, 300) << "ns";
  EXPECT_EQ(stamp_of(-0.5), -500'000'000);
}

TEST(KnownPoseTest, MovesAsTheOdometryDoes) {
  expect_pose(pose_now({{10, 20, 1 + quarter}, {3, 4, 1}}, {4, 4, 1.5}), 10, 21, 1.5 + quarter);
  // The odometry has started again.
  expect_pose(pose_now({{10, 20, 1}, {30, 40, 2}}, {0.1, 0, 0}), 10, 20, 1);
}

TEST(KnownPoseTest, IsReadFromAFileWhileItIsYoung) {
  const testing::ScopedFolder folder;
  const std::string file = folder.path() / "place";
  EXPECT_FALSE(read_pose(file, 1000)) << "there is none yet";
  ASSERT_TRUE(write_pose(file, {{1.25, -3.5, 0.1}, {7, 8, 0.9}}, 1000));
  const auto place = read_pose(file, 1009);
  ASSERT_TRUE(place);
  expect_pose(place->map, 1.25, -3.5, 0.1);
  expect_pose(place->odometry, 7, 8, 0.9);
  EXPECT_FALSE(read_pose(file, 1011)) << "too old";
  EXPECT_FALSE(read_pose(file, 999)) << "from the future";
  std::ofstream(file) << "1.25 -3.5";
  EXPECT_FALSE(read_pose(file, 1001)) << "cut";
  std::ofstream(file) << "1.25 -3.5 nan 0 0 0 1000";
  EXPECT_FALSE(read_pose(file, 1001)) << "not finite";
  EXPECT_FALSE(write_pose(folder.path() / "none" / "place", {}, 1000));
}

}  // namespace
}  // namespace slalom::nodes::transforms_test
