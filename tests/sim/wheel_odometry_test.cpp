#include "slalom/sim/wheel_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "slalom/sim/plant.hpp"

namespace slalom::sim {
namespace {

constexpr double time_step = 0.005;  // s
constexpr WheelOdometryOptions faultless{.speed_gain_error = 0,
                                         .slip_per_acceleration = 0,
                                         .speed_noise = 0,
                                         .yaw_from_gyro = true,
                                         .gyro_bias = 0,
                                         .gyro_noise = 0};

/// The odometry after 4 s of driving, and where the rear axle went, both seen from the start.
struct Driven {
  maps::Pose odometry, truth;
};
Driven drive(const WheelOdometryOptions& options, double steering) {
  const CarParameters car;
  PlantOptions plant_options;
  plant_options.dynamics.model = Model::kinematic;
  Plant plant(car, plant_options, time_step);
  plant.reset({});
  WheelOdometry odometry(car, options);
  const maps::Pose start = rear_axle(car, plant.state());
  odometry.reset(plant.state());
  for (int i = 0; i < 800; ++i) {
    plant.step({steering, 2});
    odometry.update(plant.state(), time_step);
  }
  const maps::Pose end = rear_axle(car, plant.state());
  const maps::Point moved = maps::inverse_transform(start, {end.x, end.y});
  return {odometry.pose(), {moved.x, moved.y, end.yaw}};
}

TEST(WheelOdometry, IsTrueWithoutErrors) {
  for (const double steering : {0.0, 0.15, -0.3}) {
    const Driven got = drive(faultless, steering);
    EXPECT_NEAR(got.odometry.x, got.truth.x, 0.03);
    EXPECT_NEAR(got.odometry.y, got.truth.y, 0.03);
    EXPECT_NEAR(maps::wrap_angle(got.odometry.yaw - got.truth.yaw), 0, 0.02);
  }
}

TEST(WheelOdometry, HasTheErrorsOfItsOptions) {
  WheelOdometryOptions options = faultless;
  options.speed_gain_error = 0.1;
  const Driven fast = drive(options, 0);
  EXPECT_NEAR(fast.odometry.x, 1.1 * fast.truth.x, 0.02);
  options = faultless;
  options.slip_per_acceleration = 0.05;  // the share v dv: 0.05 v^2 / 2 more
  const Driven slipping = drive(options, 0);
  EXPECT_NEAR(slipping.odometry.x, slipping.truth.x + 0.05 * 2 * 2 / 2, 0.02);
  options = faultless;
  options.gyro_bias = 0.1;
  EXPECT_NEAR(drive(options, 0).odometry.yaw, 0.4, 1e-6);
}

TEST(WheelOdometry, RejectsInvalidOptionsAndIgnoresInvalidStates) {
  EXPECT_THROW(WheelOdometry({}, {.speed_noise = -1}), std::invalid_argument);
  WheelOdometry odometry;
  odometry.reset({.speed = 1});
  odometry.update({.speed = NAN}, time_step);
  odometry.update({.speed = 1}, 0);
  EXPECT_EQ(odometry.pose().x, 0);
}

}  // namespace
}  // namespace slalom::sim
