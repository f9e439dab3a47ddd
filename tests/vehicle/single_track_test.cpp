// The single-track model against the simulator's dynamics, and what holds for any input.
#include "slalom/vehicle/model/single_track.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "slalom/sim/dynamics.hpp"
#include "support/thrown_words.hpp"

namespace slalom::vehicle {
namespace {

PathTrackingOptions car_options() {
  return {.steer_time_constant = 1e-3, .max_acceleration = 9.51, .max_deceleration = 9.51};
}

struct Drive {
  TyreModel tyres;
  double speed;         ///< m/s, at the start
  double acceleration;  ///< m/s^2
  double lateral = 6;   ///< m/s^2, that the steering asks for; tyres that saturate may have less
  double friction = SingleTrackOptions{}.friction;
};

/// How a drive of one second in the model differs from the same in the simulator.
struct Comparison {
  double error = 0;    ///< m, the largest distance between the rear axles
  double lateral = 0;  ///< m/s^2, the largest lateral acceleration of the simulated car
};

/// Steps of 0.05 s, for steering that is held and for steering that swings.
Comparison compared(const Drive& drive) {
  const PathTrackingOptions options = car_options();
  SingleTrackOptions own{.tyres = drive.tyres, .friction = drive.friction};
  const SingleTrackDynamics dynamics(options, own);
  sim::CarParameters car{.friction = drive.friction};
  sim::DynamicsOptions reference;
  reference.model = drive.tyres == TyreModel::linear ? sim::Model::single_track : sim::Model::saturating;
  const double steer =
      std::min(0.35, 1.2 * std::atan(car.wheelbase() * drive.lateral / (drive.speed * drive.speed)));
  Comparison found;
  for (const bool swinging : {false, true}) {
    SingleTrackState<double> s{0, 0, 0, drive.speed, 0, 0, 0};
    sim::CarState truth{.x = car.rear_length, .speed = drive.speed};
    for (int k = 0; k < 20; ++k) {
      const double command = swinging ? steer * std::sin(0.05 * k * 2 * 3.14159 / 0.8) : steer;
      const double acceleration = std::min(drive.acceleration, dynamics.driving_limit(s.speed));
      s = dynamics.advance(s, dynamics.lagged(s.steer, command), acceleration, own.friction, 0.05);
      for (int i = 0; i < 10; ++i)
        truth = sim::advance(car, reference, truth, {(command - truth.steer) / 0.005, acceleration}, 0.005);
      const double x = truth.x - car.rear_length * std::cos(truth.yaw),
                   y = truth.y - car.rear_length * std::sin(truth.yaw);
      found.error = std::max(found.error, std::hypot(x - s.x, y - s.y));
      found.lateral = std::max(found.lateral, std::abs(truth.speed * truth.yaw_rate));
    }
  }
  return found;
}

TEST(SingleTrack, AgreesWithTheSimulator) {
  for (const double speed : {-2.0, 0.3, 1.0, 3.0, 5.0, 8.0, 12.0, 20.0}) {
    EXPECT_LT(compared({TyreModel::linear, speed, 0}).error, 0.02) << speed << " m/s";
    EXPECT_LT(compared({TyreModel::saturating, speed, 0}).error, 0.08) << speed << " m/s";
  }
  for (const double speed : {3.0, 5.0, 8.0}) {
    EXPECT_LT(compared({TyreModel::linear, speed, -3}).error, 0.03) << speed << " m/s, braking";
    EXPECT_LT(compared({TyreModel::linear, speed, 3}).error, 0.03) << speed << " m/s, accelerating";
    EXPECT_LT(compared({TyreModel::saturating, speed, 3}).error, 0.12) << speed << " m/s, accelerating";
  }
}

TEST(SingleTrack, AgreesWithTheSimulatorAtTenToFifteenMetresPerSquareSecondOfLateralAcceleration) {
  for (const double speed : {4.0, 5.0, 6.0, 8.0, 12.0}) {
    for (const double lateral : {12.0, 15.0}) {
      const std::string drive = std::to_string(speed) + " m/s, " + std::to_string(lateral) + " m/s^2";
      const Comparison linear = compared({TyreModel::linear, speed, 0, lateral});
      EXPECT_GT(linear.lateral, 10) << drive;
      EXPECT_LT(linear.error, 0.02) << drive;
      const Comparison saturating = compared({TyreModel::saturating, speed, 0, lateral});
      EXPECT_GT(saturating.lateral, 10) << drive << ": about all that the tyres have";
      EXPECT_LT(saturating.error, lateral < 15 ? 0.13 : 0.22) << drive;
    }
  }
}

TEST(SingleTrack, AgreesWithTheSimulatorOnSlipperyGround) {
  for (const double friction : {0.7, 0.5, 0.3}) {
    const double grip = friction * 9.81;
    for (const double speed : {3.0, 5.0, 8.0, 12.0}) {
      const std::string drive = std::to_string(speed) + " m/s, friction " + std::to_string(friction);
      EXPECT_LT(compared({TyreModel::linear, speed, 0, 0.8 * grip, friction}).error, 0.01) << drive;
      EXPECT_LT(compared({TyreModel::saturating, speed, 0, 0.8 * grip, friction}).error, 0.06) << drive;
      EXPECT_LT(compared({TyreModel::saturating, speed, 0, grip, friction}).error, 0.08) << drive;
      const Comparison beyond = compared({TyreModel::saturating, speed, 0, 1.5 * grip, friction});
      EXPECT_GT(beyond.lateral, 0.75 * grip) << drive;
      EXPECT_LT(beyond.error, 0.15) << drive << ", steering beyond the grip";
    }
  }
}

TEST(SingleTrack, StandsStillAtAStandstill) {
  const SingleTrackDynamics dynamics(car_options(), {});
  SingleTrackState<double> s{1, 2, 0.5, 0, 0, 0, 0};
  for (int k = 0; k < 100; ++k) s = dynamics.advance(s, 0.4, 0.0, 1.0489, 0.05);
  EXPECT_EQ(std::tuple(s.x, s.y, s.yaw, s.yaw_rate, s.lateral), std::tuple(1, 2, 0.5, 0, 0));
}

TEST(SingleTrack, IsTheKinematicBicycleAtLowSpeed) {
  const PathTrackingOptions options = car_options();
  const SingleTrackDynamics dynamics(options, {});
  for (const double speed : {-0.2, -0.01, 0.01, 0.2}) {
    SingleTrackState<double> s{0, 0, 0, speed, 0.2, 0, 0};
    for (int k = 0; k < 40; ++k) s = dynamics.advance(s, 0.2, 0.0, 1.0489, 0.05);
    const double expected = s.speed * std::tan(0.2) / options.wheelbase();
    EXPECT_NEAR(s.yaw_rate, expected, 0.02 * std::abs(expected)) << speed << " m/s";
  }
}

TEST(SingleTrack, StaysInBoundsForAnyInputAndStep) {
  std::mt19937 random(2);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto between = [&](double low, double high) { return low * std::pow(high / low, uniform(0, 1)); };
  for (int n = 0; n < 4000; ++n) {
    PathTrackingOptions options = car_options();
    if (n % 4 < 2) options.time_step = between(0.01, 1);
    SingleTrackOptions own{.tyres = n % 2 ? TyreModel::saturating : TyreModel::linear};
    if (n % 4 < 2) own.half_steer_speed = between(0.1, 100);
    SingleTrack car(options, own);
    car.set_conditions({.friction = uniform(0.1, 1.5), .reverse = n % 3 == 0 ? 1.0 : 0.0});
    const double speed = n % 4 < 2 ? between(0.01, 20) : uniform(-5, 20), most = between(0.1, 1e4);
    SingleTrackState<double> s{
        0, 0, 0, speed, uniform(-0.4, 0.4), uniform(-5, 5), 0.3 * speed * uniform(-1, 1)};
    for (int k = 0; k < 60; ++k) {
      const double side = random() % 2 ? 1 : -1, acceleration = between(0.1, 10) * (random() % 2 ? 1 : -1);
      s = car.step(s, uniform(0, 20), Input<double, 2>{{side * most, acceleration}}, k);
      ASSERT_TRUE(std::isfinite(s.x + s.y + s.yaw)) << "sample " << n << ", step " << k;
      ASSERT_LT(std::abs(s.steer), 1.51) << n;
      ASSERT_LE(std::abs(s.yaw_rate), 100) << n;
      ASSERT_LE(std::abs(s.lateral), 1e3) << n;
      ASSERT_LE(std::abs(s.speed), 100) << n << ", step " << options.time_step << " s";
    }
  }
}

TEST(SingleTrack, BrakesNoHarderThanTurningLeavesGrip) {
  SingleTrackOptions own{.usable_grip = 0.9};
  const SingleTrackDynamics dynamics(car_options(), own);
  const double most = 0.9 * own.friction * 9.81;
  for (const double turning : {0.0, 0.5, 0.9, 2.0}) {
    const SingleTrackState<double> s{0, 0, 0, 5, 0, turning * most / 5, 0};
    const double left = dynamics.braking_limit(dynamics.grip_left(s, own.friction));
    EXPECT_NEAR(left, most * std::max(0.1, std::sqrt(std::max(1 - turning * turning, 0.0))), 1e-9) << turning;
  }
}

TEST(SingleTrack, KnowsTheForceOfTheStepBefore) {
  SingleTrackOptions own{.tyres = TyreModel::linear, .braking_share = 0.5};
  const SingleTrackDynamics dynamics(car_options(), own);
  SingleTrackState<double> s{0, 0, 0, 6, 0, 0, 0};
  for (int k = 0; k < 40; ++k) s = dynamics.advance(s, 0.05, 0.0, own.friction, 0.05);
  EXPECT_GT(s.speed * s.yaw_rate, 4);
  EXPECT_NEAR(std::sqrt(s.squared_force), s.speed * s.yaw_rate, 0.01)
      << "on a circle that is the lateral acceleration";
  EXPECT_NEAR(dynamics.grip_share(4.0, own.friction), 4 / (own.friction * 9.81), 1e-9);
  const SingleTrackState<double> straight{0, 0, 0, 6, 0, 0, 0};
  const auto force = [&](double acceleration) {
    return std::sqrt(dynamics.advance(straight, 0.0, acceleration, own.friction, 0.05).squared_force);
  };
  EXPECT_NEAR(force(4), 4, 1e-9);
  EXPECT_NEAR(force(-4), 4 / 0.5, 1e-9) << "brakes count by what they do right after a command";
}

TEST(SingleTrack, BrakesWithItsShareOfTheGripThatIsLeft) {
  SingleTrackOptions own{.braking_share = 0.7};
  const SingleTrack car(car_options(), own);
  const SingleTrackState<double> s{0, 0, 0, 5, 0, 0, 0};
  const double most = own.usable_grip * own.friction * 9.81;
  EXPECT_NEAR(car.limited(s, 10.0, -20.0), -0.7 * most, 1e-9);
  EXPECT_NEAR(car.limited(s, 10.0, 20.0), most, 1e-9) << "the motor may use all of it";
}

TEST(SingleTrack, ForTheLapTimeDrivesAtItsShareOfThePathsSpeed) {
  SingleTrackOptions own{.objective = Objective::lap_time, .speed_share = 1.1};
  SingleTrack car(car_options(), own);
  car.set_conditions({.friction = own.friction, .top_speed = 6});
  const SingleTrackState<double> s{0, 0, 0, 5, 0, 0, 0};
  EXPECT_NEAR(car.limited(s, 4.6, 9.0), (1.1 * 4.6 - 5) / 0.05, 1e-9);
  EXPECT_NEAR(car.limited({0, 0, 0, 5.9, 0, 0, 0}, 9.0, 9.0), (6 - 5.9) / 0.05, 1e-9)
      << "the top speed is a limit too";
}

TEST(SingleTrack, ForTheLapTimeAPlanMustEndAtASpeedWithWhichTheCarCanDriveOn) {
  SingleTrackOptions own{.objective = Objective::lap_time, .usable_grip = 0.8, .grip_weight = 100};
  const SingleTrack car(car_options(), own);
  const auto at = [](double speed) { return SingleTrackState<double>{0, 0, 0, speed, 0, 0, 0}; };
  EXPECT_EQ(car.overspeed_cost(at(5), 5.0), 0);
  EXPECT_NEAR(car.overspeed_cost(at(6), 5.0), 100 * std::pow(0.8 * (1.44 - 1), 2), 1e-9);
  EXPECT_EQ(car.steps_behind(at(6), 5.0), 0);
  // With a = 0.8 mu g the car has caught up after (5 - 4) / a, and is (5 - 4)^2 / (2 a) m behind then.
  const double a = 0.8 * own.friction * 9.81;
  EXPECT_NEAR(car.steps_behind(at(4), 5.0), 1 / (2 * a) / 5 / 0.05, 1e-9);
}

TEST(SingleTrack, RefusesAHeldInputAndAnInertiaThatNoCarOfItsMassHas) {
  PathTrackingOptions held = car_options();
  held.hold_first_input = true;
  EXPECT_THROW(SingleTrack{held}, std::invalid_argument);
  SingleTrackOptions own;
  EXPECT_NO_THROW(SingleTrack(car_options(), own));
  for (const double inertia : {0.004, 0.5}) {  // kg m^2: radii of gyration of 0.1 and 1.1 wheelbases
    own.inertia = inertia;
    expect_error_with<std::invalid_argument>({"vehicle.inertia", "radius of gyration", "0.1 to 1"},
                                             [&] { SingleTrack(car_options(), own); });
  }
}

}  // namespace
}  // namespace slalom::vehicle
