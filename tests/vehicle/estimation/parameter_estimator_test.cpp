// Friction, steering gain and delay found while a simulated car drives: from wrong given values, without
// turning, on all instruction sets, with and without noise.
#include "vehicle/estimation/parameter_estimator.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "slalom/core/random.hpp"
#include "slalom/sim/plant.hpp"
#include "slalom/sim/wheel_odometry.hpp"
#include "slalom/vehicle/model/single_track.hpp"

namespace slalom::vehicle::detail::parameter_estimator_test {
namespace {

constexpr double period = 0.025, time_step = 0.005;  // s

PathTrackingOptions car_options() {
  return {.steer_time_constant = 0.05, .dead_time = 0.025, .max_acceleration = 9, .max_deceleration = 9};
}

/// A drive of a simulated car and what its estimator was given.
struct Drive {
  sim::Model tyres = sim::Model::saturating;
  double friction = 1.0489;
  double gain = 1;    ///< of the steering
  double offset = 0;  ///< rad, added to the angle of the wheels; the driver steers against it
  double delay = 0;   ///< s, besides the plant's dead time of 20 ms
  double given_friction = 1.0489, given_delay = 0.025;
  double speed = 4;                           ///< m/s
  double swing = 0.2;                         ///< rad, amplitude of the steering
  double position_noise = 0, yaw_noise = 0;   ///< m, rad, standard deviations
  double duration = 3;                        ///< s, after reaching the speed
  bool from_rest = false, hesitates = false;  ///< `duration` begins at rest; speeds up slowly at first
};

ParameterEstimate after(const Drive& drive, const EstimationOptions& options = {}) {
  sim::CarParameters car{.friction = drive.friction};
  sim::PlantOptions plant_options;
  plant_options.dynamics.model = drive.tyres;
  sim::Plant plant(car, plant_options, time_step);
  plant.reset({.speed = drive.from_rest ? 0 : drive.speed});
  const SingleTrackDynamics dynamics(
      car_options(),
      {.tyres = drive.tyres == sim::Model::saturating ? TyreModel::saturating : TyreModel::linear});
  ParameterEstimator estimator(dynamics, options, drive.given_friction, drive.given_delay, period);
  RandomStream noise({7, 0});
  std::deque<double> commands(static_cast<std::size_t>(std::lround(drive.delay / time_step)), 0.0);
  double wheel = 0;
  for (int tick = 0; tick * period < drive.duration; ++tick) {
    const double time = tick * period;
    const sim::CarState& state = plant.state();
    maps::Pose pose = sim::rear_axle(car, state);
    pose.x += drive.position_noise * noise.normal();
    pose.y += drive.position_noise * noise.normal();
    pose.yaw += drive.yaw_noise * noise.normal();
    estimator.update({pose, state.speed, state.yaw_rate, state.slip});
    const double steer =
        drive.swing * std::sin(2 * 3.14159 * time / 1.5) * std::cos(0.7 * time) - drive.offset;
    estimator.send({steer, drive.speed});
    for (int k = 0; k < std::lround(period / time_step); ++k) {
      commands.push_back(steer);
      // The servo's lag, before the plant's own dead time.
      wheel += (drive.gain * commands.front() + drive.offset - wheel) * (1 - std::exp(-time_step / 0.05));
      commands.pop_front();
      const bool waits = drive.from_rest && time + k * time_step < drive.delay;
      const bool slow = drive.hesitates && plant.state().speed < 0.55;
      plant.step({wheel, waits ? 0 : slow ? plant.state().speed + 0.8 : drive.speed});
    }
  }
  return estimator.estimate();
}

TEST(ParameterEstimator, AStartFromRestShowsALongDelayBeforeTheFirstTurn) {
  for (const double d : {0.06, 0.1, 0.14})
    EXPECT_NEAR(after({.delay = d, .swing = 0, .duration = 1, .from_rest = true}).delay / d, 0.73, 0.05);
  for (const bool late : {false, true})
    EXPECT_DOUBLE_EQ(after({.swing = 0, .duration = 1, .from_rest = true, .hesitates = late}).delay, 0.025);
}

TEST(ParameterEstimator, FindsLowFrictionAndALongDelayWithinThreeSeconds) {
  const ParameterEstimate found = after({.friction = 0.7, .delay = 0.1});
  EXPECT_NEAR(found.friction, 0.7, 0.07);
  EXPECT_NEAR(found.delay, 0.12, 0.015);
  EXPECT_NEAR(found.steering_gain, 1, 0.07);
  EXPECT_LT(found.cautious_friction, 0.75);
  EXPECT_GT(found.confidence, 0.7);
}

TEST(ParameterEstimator, FindsOtherGroundsToo) {
  for (const auto tyres : {sim::Model::saturating, sim::Model::single_track})
    for (const double friction : {0.4, 0.55, 0.85, 1.0489}) {
      const ParameterEstimate found =
          after({.tyres = tyres, .friction = friction, .speed = friction < 0.5 ? 3.0 : 4.0});
      EXPECT_NEAR(found.friction / friction, 1, 0.12) << friction;
      EXPECT_NEAR(found.delay, 0.02, 0.015) << friction;
    }
}

TEST(ParameterEstimator, FindsTheSteeringGain) {
  EXPECT_NEAR(after({.gain = 0.93, .swing = 0.12}).steering_gain, 0.93, 0.04);
  EXPECT_NEAR(after({.gain = 1.08, .swing = 0.12}).steering_gain, 1.08, 0.06);
}

TEST(ParameterEstimator, KeepsTheGivenValuesWithoutTurningAndSaysSo) {
  const ParameterEstimate found = after({.friction = 0.5, .delay = 0.1, .swing = 0.002});
  EXPECT_LT(found.confidence, 0.1);
  EXPECT_NEAR(found.friction, 1.0489, 0.05);
  EXPECT_LT(found.cautious_friction, 0.5) << "what nobody has measured may be low";
  EXPECT_GT(found.cautious_friction, 0.35);
  EXPECT_NEAR(found.delay, 0.025, 0.02);
  EXPECT_NEAR(found.steering_gain, 1, 0.02);
}

TEST(ParameterEstimator, FindsAnOffsetOfTheSteeringOnALongStraightAndNothingElse) {
  const ParameterEstimate found = after({.offset = 0.01, .speed = 8, .swing = 0, .duration = 15});
  EXPECT_LT(found.confidence, 0.1);
  EXPECT_NEAR(found.friction, 1.0489, 0.05);
  EXPECT_NEAR(found.steering_offset, 0.01, 0.001);
}

TEST(ParameterEstimator, TakesNoWrongGainForAnOffset) {
  const ParameterEstimate found = after({.gain = 0.93, .speed = 1.5, .swing = 0.3, .duration = 6});
  EXPECT_NEAR(found.steering_offset, 0, 0.005);
}

TEST(ParameterEstimator, StandsTheNoiseOfALocalisation) {
  const ParameterEstimate found =
      after({.friction = 0.7, .delay = 0.1, .position_noise = 0.015, .yaw_noise = 0.005, .duration = 4});
  EXPECT_NEAR(found.friction, 0.7, 0.14);
  EXPECT_NEAR(found.delay, 0.12, 0.03);
}

TEST(ParameterEstimator, TheLowerTheQuantileTheMoreCautious) {
  EstimationOptions options;
  double before = 0;
  for (const double quantile : {0.05, 0.2, 0.5}) {
    options.friction_quantile = quantile;
    const double cautious = after({.friction = 0.7}, options).cautious_friction;
    EXPECT_GT(cautious, before);
    before = cautious;
  }
}

}  // namespace
}  // namespace slalom::vehicle::detail::parameter_estimator_test
