// The observer of yaw rate, slip and speed against the truth of the simulator.
#include "vehicle/estimation/state_observer.hpp"

#include <gtest/gtest.h>

#include "slalom/core/random.hpp"
#include "slalom/sim/imu.hpp"
#include "slalom/sim/plant.hpp"
#include "slalom/sim/wheel_odometry.hpp"

namespace slalom::vehicle::detail::state_observer_test {
namespace {

constexpr double period = 0.025, time_step = 0.005;  // s

/// A drive of a simulated car with saturating tyres, and what its observer gets.
struct Drive {
  double friction = 1.0489, assumed_friction = 1.0489;
  double position_noise = 0, yaw_noise = 0, speed_noise = 0;  ///< m, rad, m/s, standard deviations
  double wheel_error = 0, wheel_slip = 0;  ///< shares of the speed: always, and per m/s^2 of acceleration
  bool imu = false;
  /// Standard deviation of the position along the car, m; `position_noise` is then that across it.
  double along_noise = 0;
  bool mean_of_both = false;  ///< the covariance given has the mean of both variances along each axis
};

/// Root mean square errors.
struct Errors {
  double yaw_rate = 0, slip = 0, speed = 0;  ///< rad/s, rad, m/s
  double across = 0;                         ///< m, of the position, across the car
};

/// The covariance of a position with these deviations (m) along and across a car, and of its yaw (rad).
PoseCovariance covariance_of(double along, double across, double yaw, double yaw_deviation) {
  const double c = std::cos(yaw), s = std::sin(yaw), a = along * along, b = across * across;
  return {{{c * c * a + s * s * b, c * s * (a - b), 0},
           {c * s * (a - b), s * s * a + c * c * b, 0},
           {0, 0, yaw_deviation * yaw_deviation}}};
}

std::unique_ptr<DynamicVehicleModel> model_with(double friction) {
  VehicleOptions options;
  options.model = vehicle_model("single_track");
  options.steer_time_constant = 0.01;
  options.dead_time = 0.02;
  options.max_acceleration = options.max_deceleration = 9;
  options.own_of<SingleTrackOptions>().friction = friction;
  return std::unique_ptr<DynamicVehicleModel>(
      dynamic_cast<DynamicVehicleModel*>(make_vehicle_model(options).release()));
}

Errors errors_of(const Drive& drive) {
  sim::CarParameters car{.friction = drive.friction};
  sim::PlantOptions plant_options;
  plant_options.dynamics.model = sim::Model::saturating;
  sim::Plant plant(car, plant_options, time_step);
  plant.reset({.speed = 4});
  sim::Imu imu({.seed = 3});
  imu.reset(plant.state());
  const auto model = model_with(drive.assumed_friction);
  StateObserver observer({}, period, 0, 0.02);
  RandomStream noise({5, 0});
  Errors sum;
  int count = 0;
  double speed_before = plant.state().speed;
  for (int tick = 0; tick < 320; ++tick) {
    const double time = tick * period;
    const sim::CarState& state = plant.state();
    const maps::Pose truth = sim::rear_axle(car, state);
    const double across_noise = drive.position_noise,
                 along_noise = drive.along_noise > 0 ? drive.along_noise : across_noise;
    const double mean = std::sqrt(0.5 * (along_noise * along_noise + across_noise * across_noise));
    ObserverInput input{truth, state.speed,
                        drive.mean_of_both
                            ? covariance_of(mean, mean, 0, drive.yaw_noise)
                            : covariance_of(along_noise, across_noise, truth.yaw, drive.yaw_noise)};
    const maps::Point moved =
        maps::transform(truth, {along_noise * noise.normal(), across_noise * noise.normal()});
    input.pose.x = moved.x;
    input.pose.y = moved.y;
    input.pose.yaw += drive.yaw_noise * noise.normal();
    input.speed *= 1 + drive.wheel_error + drive.wheel_slip * (state.speed - speed_before) / period;
    speed_before = state.speed;
    input.speed += drive.speed_noise * noise.normal();
    if (drive.imu) input.imu = imu.read();
    observer.update(*model, input, drive.assumed_friction);
    if (time > 1) {
      ++count;
      sum.yaw_rate += std::pow(observer.now().yaw_rate - state.yaw_rate, 2);
      sum.slip += std::pow(observer.now().slip - state.slip, 2);
      sum.speed += std::pow(observer.now().speed - state.speed, 2);
      sum.across +=
          std::pow(maps::inverse_transform(truth, {observer.now().pose.x, observer.now().pose.y}).y, 2);
    }
    const Command command{0.16 * std::sin(2 * 3.14159 * time / 1.6), 4 + std::sin(time)};
    observer.send(command);
    for (int k = 0; k < std::lround(period / time_step); ++k) {
      plant.step(command);
      imu.update(plant.state(), time_step);
    }
  }
  return {std::sqrt(sum.yaw_rate / count), std::sqrt(sum.slip / count), std::sqrt(sum.speed / count),
          std::sqrt(sum.across / count)};
}

constexpr Drive localised{.position_noise = 0.02, .yaw_noise = 0.006, .speed_noise = 0.03};

TEST(StateObserver, FollowsExactMeasurements) {
  const Errors e = errors_of({});
  EXPECT_LT(e.yaw_rate, 0.08);
  EXPECT_LT(e.slip, 0.012);
  EXPECT_LT(e.speed, 0.05);
}

TEST(StateObserver, HasSmallErrorsWithALocalisedPose) {
  const Errors e = errors_of(localised);
  // Differences of the noisy heading would have 0.006 sqrt(2) / 0.025 s = 0.34 rad/s.
  EXPECT_LT(e.yaw_rate, 0.17);
  EXPECT_LT(e.slip, 0.03);
  EXPECT_LT(e.speed, 0.08);
}

// Tyres are smaller than configured, and wheels slip while the car brakes or accelerates.
TEST(StateObserver, LearnsTheSizeOfTheWheels) {
  Drive drive = localised;
  drive.wheel_error = 0.04;
  drive.wheel_slip = 0.01;
  EXPECT_LT(errors_of(drive).speed, 0.08) << "the wheels are wrong by 0.16 m/s";
}

TEST(StateObserver, AnImuGivesTheYawRate) {
  Drive drive = localised;
  drive.imu = true;
  const Errors without = errors_of(localised), with = errors_of(drive);
  EXPECT_LT(with.yaw_rate, 0.7 * without.yaw_rate);
  EXPECT_LT(with.slip, 0.02);
}

TEST(StateObserver, WithTheWrongFrictionAnImuHelpsMost) {
  Drive drive = localised;
  drive.friction = 0.6;
  const double without = errors_of(drive).slip;
  drive.imu = true;
  EXPECT_LT(errors_of(drive).slip, 0.8 * without);
}

// Between two walls a localiser knows the position across them far better than that along them.
TEST(StateObserver, KnowsInWhichDirectionAPoseIsCertain) {
  Drive drive{.friction = 0.9, .position_noise = 0.01, .yaw_noise = 0.006, .along_noise = 0.15};
  const Errors e = errors_of(drive);
  drive.mean_of_both = true;
  const Errors mean = errors_of(drive);
  EXPECT_LT(e.across, 0.02);
  EXPECT_LT(e.across, 0.5 * mean.across);
  EXPECT_LT(e.slip, mean.slip);
}

TEST(StateObserver, ToleratesAnInvalidCovariance) {
  const auto model = model_with(1);
  constexpr double huge = 1e300, none = std::numeric_limits<double>::quiet_NaN();
  const PoseCovariance hostile[] = {{{{1, 9, 9}, {9, 1, 9}, {9, 9, 1}}},
                                    {{{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}},
                                    {{{none, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                    {{{2.4e5, -2.4e5 - 0.0018, 0}, {-2.4e5 - 0.0018, 2.4e5, 0}, {0, 0, 0}}},
                                    {{{huge, -huge, huge}, {huge, huge, huge}, {huge, huge, huge}}}};
  for (const PoseCovariance& covariance : hostile) {
    StateObserver observer({}, period, 0, 0.02);
    for (int i = 0; i < 200; ++i) {
      const double way = 0.1 * i * std::sqrt(0.5);
      observer.update(*model, {{way, way, 0.25 * std::numbers::pi}, 4, covariance}, 1);
      observer.send({0, 4});
      const VehicleStart& now = observer.now();
      ASSERT_NEAR(now.speed, 4, 2);
      ASSERT_TRUE(
          std::isfinite(now.pose.x + now.pose.y + now.pose.yaw + now.speed + now.yaw_rate + now.slip));
    }
  }
}

TEST(StateObserver, BeginsAnewAfterAJumpAndAtAStandstill) {
  const auto model = model_with(1);
  StateObserver observer({}, period, 0, 0.02);
  for (int i = 0; i < 40; ++i) {
    observer.update(*model, {{0.1 * i, 0, 0}, 4}, 1);
    observer.send({0, 4});
  }
  EXPECT_NEAR(observer.now().pose.x, 3.9, 0.01);
  EXPECT_NEAR(observer.now().yaw_rate, 0, 0.01);
  observer.update(*model, {{20, 5, 1}, 4}, 1);
  EXPECT_EQ(observer.now().pose.x, 20);
  observer.send({0, 0});
  observer.update(*model, {{20, 5, 1}, 0}, 1);
  EXPECT_EQ(observer.now().speed, 0);
  EXPECT_EQ(observer.now().slip, 0);
}

}  // namespace
}  // namespace slalom::vehicle::detail::state_observer_test
