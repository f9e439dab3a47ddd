#include <gtest/gtest.h>

#include "vehicle/localiser_drive.hpp"

namespace slalom::vehicle::localiser_input_test {
namespace {

using test::Drive;
using test::error_of;
using test::wren;

class InvalidLocaliserInput : public ::testing::Test {
 protected:
  InvalidLocaliserInput() {
    localiser.start_at(drive.truth());
    for (int i = 0; i < 20; ++i) next();
    EXPECT_EQ(localiser.output().status, LocaliserStatus::ok);
  }
  const LocaliserOutput& next() {
    drive.step();
    return localiser.update(drive.input());
  }
  /// The car's true error stays small through the fault and the localiser is well afterwards.
  void expect_recovery() {
    for (int i = 0; i < 40; ++i) next();
    EXPECT_EQ(localiser.output().status, LocaliserStatus::ok);
    EXPECT_LT(error_of(localiser.output().pose, drive.truth()).distance, 0.25);
  }
  Localiser localiser{wren().course.map};
  Drive drive{wren(), wren().at(0.2), 3};
};

TEST_F(InvalidLocaliserInput, FollowsOdometryWithoutReadings) {
  const std::vector<float> nan(1081, std::numeric_limits<float>::quiet_NaN()), far(1081, 30.0F), none;
  for (int i = 0; i < 12; ++i) {
    drive.step();
    LocaliserInput input = drive.input();
    if (i % 4 == 3)
      input.scan.angle_increment = NAN;
    else
      input.scan.ranges = *std::array{&nan, &far, &none}[i % 4];
    EXPECT_EQ(localiser.update(input).status, LocaliserStatus::bad_scan);
    EXPECT_LT(error_of(localiser.output().pose, drive.truth()).distance, 0.25);
  }
  expect_recovery();
}

TEST_F(InvalidLocaliserInput, ToleratesSomeNanReadings) {
  for (int i = 0; i < 40; ++i) {
    drive.step();
    for (std::size_t k = 0; k < drive.ranges().size(); k += 2) drive.ranges()[k] = NAN;
    const auto& out = localiser.update(drive.input());
    EXPECT_EQ(out.status, LocaliserStatus::ok);
    EXPECT_GT(out.beams, 40);
  }
  expect_recovery();
}

TEST_F(InvalidLocaliserInput, IgnoresNonFiniteOdometryAndStarts) {
  const maps::Pose before = localiser.output().pose;
  EXPECT_FALSE(localiser.start_at({NAN, 0, 0}));
  LocaliserInput input = drive.input();
  input.odometry.x = NAN;
  input.stamp += 0.025;
  EXPECT_EQ(localiser.update(input).status, LocaliserStatus::bad_odometry);
  input = drive.input();
  input.stamp = std::numeric_limits<double>::infinity();
  EXPECT_EQ(localiser.update(input).status, LocaliserStatus::bad_odometry);
  EXPECT_EQ(localiser.output().pose.x, before.x);
  expect_recovery();
}

TEST_F(InvalidLocaliserInput, BridgesOdometryJumps) {
  drive.step();
  LocaliserInput input = drive.input();
  input.odometry.x += 5;
  EXPECT_EQ(localiser.update(input).status, LocaliserStatus::odometry_jump);
  EXPECT_LT(error_of(localiser.output().pose, drive.truth()).distance, 0.3);
  drive.step();
  EXPECT_EQ(localiser.update(drive.input()).status, LocaliserStatus::odometry_jump);  // and back
  expect_recovery();
}

TEST_F(InvalidLocaliserInput, IgnoresOldScansUntilTheClockIsReset) {
  LocaliserInput input = drive.input();
  input.stamp -= 0.1;
  EXPECT_EQ(localiser.update(input).status, LocaliserStatus::stale);
  input.stamp -= 100;
  EXPECT_EQ(localiser.update(input).status, LocaliserStatus::odometry_jump);
  input.stamp += 0.025;
  EXPECT_EQ(localiser.update(input).status, LocaliserStatus::ok);
}

}  // namespace
}  // namespace slalom::vehicle::localiser_input_test
