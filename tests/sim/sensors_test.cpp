// Inertial measurement unit and wheel odometry: known answers of simple motions, bias and noise.
#include "slalom/sim/imu.hpp"

#include <gtest/gtest.h>

#include "slalom/sim/plant.hpp"
#include "slalom/sim/wheel_odometry.hpp"

namespace slalom::sim::sensors_test {
namespace {

constexpr double time_step = 0.005;  // s
constexpr ImuOptions faultless{
    .gyro_bias = 0, .gyro_noise = 0, .accelerometer_bias = 0, .accelerometer_noise = 0};

/// The state on a circle at constant speed (m/s) and yaw rate (rad/s), with a constant slip (rad).
CarState on_circle(double speed, double yaw_rate, double slip, double time) {
  return {.speed = speed,
          .yaw = std::remainder(yaw_rate * time, 2 * 3.141592653589793),
          .yaw_rate = yaw_rate,
          .slip = slip};
}

TEST(Imu, ReadsTheCentripetalAccelerationAcrossTheDirectionOfTravel) {
  Imu imu(faultless);
  imu.reset(on_circle(4, -1.5, 0.1, 0));
  for (int i = 1; i <= 2000; ++i) {  // more than a turn
    imu.update(on_circle(4, -1.5, 0.1, time_step * i), time_step);
    const ImuReading reading = imu.read();
    EXPECT_NEAR(reading.yaw_rate, -1.5, 1e-12);
    EXPECT_NEAR(reading.leftward, -6 * std::cos(0.1), 1e-3);
    EXPECT_NEAR(reading.forward, 6 * std::sin(0.1), 1e-3);
  }
}

TEST(Imu, ReadsTheMeanSinceTheLastReading) {
  Imu imu(faultless);
  CarState state;
  imu.reset(state);
  for (int i = 1; i <= 10; ++i) {
    state.speed += (i <= 5 ? 2.0 : 4.0) * time_step;
    imu.update(state, time_step);
  }
  EXPECT_NEAR(imu.read().forward, 3, 1e-9);
  EXPECT_NEAR(imu.read().forward, 3, 1e-9);  // nothing new
}

TEST(Imu, HasTheBiasAndNoiseOfItsOptions) {
  double squares = 0;
  constexpr int drives = 400;
  for (int drive = 0; drive < drives; ++drive) {
    ImuOptions options = faultless;
    options.seed = static_cast<std::uint64_t>(drive);
    options.gyro_bias = 0.3;
    Imu imu(options);
    imu.reset({});
    imu.update({}, time_step);
    const double bias = imu.read().yaw_rate;
    imu.update({}, time_step);
    EXPECT_EQ(imu.read().yaw_rate, bias);
    squares += bias * bias;
  }
  EXPECT_NEAR(std::sqrt(squares / drives), 0.3, 0.03);

  ImuOptions options = faultless;
  options.accelerometer_noise = 0.5;
  Imu imu(options);
  imu.reset({});
  squares = 0;
  for (int i = 0; i < 4000; ++i) {
    imu.update({}, time_step);
    squares += std::pow(imu.read().leftward, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / 4000), 0.5, 0.02);
}

TEST(Imu, IgnoresWhatIsNotFinite) {
  Imu imu(faultless);
  imu.reset({});
  CarState bad{.speed = std::nan("")};
  imu.update(bad, time_step);
  imu.update({}, 0);
  EXPECT_EQ(imu.read().forward, 0);
}

constexpr WheelOdometryOptions exact_wheels{.speed_gain_error = 0,
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
  PlantOptions plant_options{.dynamics = {.model = Model::kinematic}};
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
    const Driven got = drive(exact_wheels, steering);
    EXPECT_NEAR(got.odometry.x, got.truth.x, 0.03);
    EXPECT_NEAR(got.odometry.y, got.truth.y, 0.03);
    EXPECT_NEAR(maps::wrap_angle(got.odometry.yaw - got.truth.yaw), 0, 0.02);
  }
}

TEST(WheelOdometry, HasTheErrorsOfItsOptions) {
  WheelOdometryOptions options = exact_wheels;
  options.speed_gain_error = 0.1;
  const Driven fast = drive(options, 0);
  EXPECT_NEAR(fast.odometry.x, 1.1 * fast.truth.x, 0.02);
  options = exact_wheels;
  options.slip_per_acceleration = 0.05;  // the share v dv: 0.05 v^2 / 2 more
  const Driven slipping = drive(options, 0);
  EXPECT_NEAR(slipping.odometry.x, slipping.truth.x + 0.05 * 2 * 2 / 2, 0.02);
  options = exact_wheels;
  options.gyro_bias = 0.1;
  EXPECT_NEAR(drive(options, 0).odometry.yaw, 0.4, 1e-6);
}

TEST(WheelOdometry, IgnoresInvalidStates) {
  WheelOdometry odometry;
  odometry.reset({.speed = 1});
  odometry.update({.speed = NAN}, time_step);
  odometry.update({.speed = 1}, 0);
  EXPECT_EQ(odometry.pose().x, 0);
}

}  // namespace
}  // namespace slalom::sim::sensors_test
