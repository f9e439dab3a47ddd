// Where sensors are, stamps, and the file with the last pose.
#include "bridge/frames.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "bridge/pose_file.hpp"
#include "support/temporary_folder.hpp"

namespace slalom_bridge {
namespace {

constexpr double quarter = std::numbers::pi / 2;  // rad

TEST(FramesMount, AnUprightSensorIsAPoseInThePlane) {
  const Mount turned = mount_of(0.3, -0.1, 0.2, 0, 0, std::sin(quarter / 2), std::cos(quarter / 2));
  EXPECT_TRUE(turned.upright());
  const Pose pose = turned.planar();
  EXPECT_EQ(pose.x, 0.3);
  EXPECT_EQ(pose.y, -0.1);
  EXPECT_NEAR(pose.yaw, quarter, 1e-12);
  EXPECT_NEAR(turned.rotation[0][1], -1, 1e-12) << "its y axis points backwards";
}

TEST(FramesMount, ASensorThatHangsUpsideDownIsNotUpright) {
  const Mount hanging = mount_of(0, 0, 0, 1, 0, 0, 0);  // turned by 180 degrees about x
  EXPECT_FALSE(hanging.upright());
  EXPECT_NEAR(hanging.rotation[1][1], -1, 1e-12);
  EXPECT_NEAR(hanging.rotation[2][2], -1, 1e-12) << "a turn to its left is one to the right of the car";
}

TEST(FramesMount, RotatesVectorsToTheAxesOfTheCar) {
  const Mount turned = mount_of(0, 0, 0, 0, 0, std::sin(quarter / 2), std::cos(quarter / 2));
  const double ahead_of_sensor[3] = {2, 0, 0}, up[3] = {0, 0, 3};
  EXPECT_NEAR(along(0, turned, ahead_of_sensor), 0, 1e-12);
  EXPECT_NEAR(along(1, turned, ahead_of_sensor), 2, 1e-12) << "it looks to the left of the car";
  EXPECT_NEAR(along(2, turned, up), 3, 1e-12);
  const Mount hanging = mount_of(0, 0, 0, 1, 0, 0, 0);
  EXPECT_NEAR(along(2, hanging, up), -3, 1e-12);
}

TEST(FramesStamp, SurvivesTheWayThroughSeconds) {
  const Stamp stamp = 1'700'000'000'250'000'000;
  EXPECT_NEAR(static_cast<double>(stamp_of(in_seconds(stamp)) - stamp), 0, 300) << "ns";
  EXPECT_EQ(stamp_of(-0.5), -500'000'000);
}

TEST(PoseFile, IsReadWhileItIsYoung) {
  const slalom::testing::ScopedFolder folder;
  const std::string file = folder.path() / "pose";
  EXPECT_FALSE(read_pose(file, 1000, 10)) << "there is none yet";
  ASSERT_TRUE(write_pose(file, {1.25, -3.5, 0.1}, 1000));
  const auto pose = read_pose(file, 1009, 10);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->x, 1.25);
  EXPECT_EQ(pose->y, -3.5);
  EXPECT_EQ(pose->yaw, 0.1);
  EXPECT_FALSE(read_pose(file, 1011, 10)) << "too old";
  EXPECT_FALSE(read_pose(file, 999, 10)) << "from the future";
  std::ofstream(file) << "1.25 -3.5";
  EXPECT_FALSE(read_pose(file, 1001, 10)) << "cut";
  EXPECT_FALSE(write_pose(folder.path() / "none" / "pose", {}, 1000));
}

}  // namespace
}  // namespace slalom_bridge
