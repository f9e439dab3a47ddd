// Results of identify_tyres for simulated cars whose tyres and steering are known.
#include "slalom/vehicle/model/tyre_identification.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "slalom/core/random.hpp"
#include "slalom/sim/plant.hpp"
#include "slalom/sim/wheel_odometry.hpp"

namespace slalom::vehicle::tyre_identification_test {
namespace {

constexpr double period = 0.025, time_step = 0.005;  // s

/// A simulated car and how it is driven.
struct Truth {
  double friction = 0.8, front = 5.6, rear = 6.6;
  double gain = 0.95, offset = 0.01, delay = 0.06,
         lag = 0.07;    ///< delay: of the servo and the plant together
  double speed = 4;     ///< m/s, the mean
  double swing = 0.25;  ///< rad, amplitude of the steering
  double position_noise = 0.01, yaw_noise = 0.004, speed_noise = 0.03;
  double duration = 60;  ///< s
};

std::vector<DrivenSample> drive(const Truth& truth) {
  sim::CarParameters car{
      .friction = truth.friction, .cornering_front = truth.front, .cornering_rear = truth.rear};
  sim::PlantOptions options;
  options.dynamics.model = sim::Model::saturating;
  sim::Plant plant(car, options, time_step);
  plant.reset({.speed = truth.speed});
  RandomStream noise({11, 0});
  const double servo_delay = truth.delay - options.steering_dead_time;
  std::deque<double> commands(static_cast<std::size_t>(std::lround(servo_delay / time_step)), 0.0);
  std::vector<DrivenSample> samples;
  double wheel = truth.offset;
  for (int tick = 0; tick * period < truth.duration; ++tick) {
    const double time = tick * period;
    const sim::CarState& state = plant.state();
    const maps::Pose pose = sim::rear_axle(car, state);
    const double steer = truth.swing * std::sin(4.1 * time) * std::cos(0.7 * time);
    samples.push_back({time, pose.x + truth.position_noise * noise.normal(),
                       pose.y + truth.position_noise * noise.normal(),
                       pose.yaw + truth.yaw_noise * noise.normal(),
                       state.speed + truth.speed_noise * noise.normal(), steer});
    for (int k = 0; k < std::lround(period / time_step); ++k) {
      commands.push_back(steer);
      wheel +=
          (truth.gain * commands.front() + truth.offset - wheel) * (1 - std::exp(-time_step / truth.lag));
      commands.pop_front();
      plant.step({wheel, truth.speed * (1 + 0.2 * std::sin(0.5 * time))});
    }
  }
  return samples;
}

TEST(TyreIdentification, FindsTyresFrictionAndSteeringOfANoisyDrive) {
  const Truth truth;
  const TyreIdentification found = identify_tyres(drive(truth), {}, {});
  EXPECT_NEAR(found.friction.value, truth.friction, 0.06 * truth.friction);
  EXPECT_NEAR(found.cornering_front.value, truth.front, 0.1 * truth.front);
  EXPECT_NEAR(found.cornering_rear.value, truth.rear, 0.1 * truth.rear);
  EXPECT_NEAR(found.steering_gain.value, truth.gain, 0.03);
  EXPECT_NEAR(found.steering_offset.value, truth.offset, 0.002);
  EXPECT_NEAR(found.delay.value, truth.delay, 0.01);
  EXPECT_NEAR(found.time_constant.value, truth.lag, 0.01);
  EXPECT_LT(found.friction.deviation, 0.03);
  EXPECT_GT(found.grip_used, 0.7);
  EXPECT_LT(found.yaw_residual, 0.02);
  EXPECT_LT(found.sideways_residual, 0.03);
}

TEST(TyreIdentification, FindsOtherGroundsAndTyres) {
  const Truth truths[] = {{.friction = 0.5, .front = 5, .rear = 6.5, .speed = 3.2, .swing = 0.3},
                          {.friction = 1.0489, .front = 6, .rear = 7, .speed = 4.5}};
  for (const Truth& truth : truths) {
    const TyreIdentification found = identify_tyres(drive(truth), {}, {});
    EXPECT_NEAR(found.friction.value, truth.friction, 0.1 * truth.friction) << truth.front;
    EXPECT_NEAR(found.cornering_front.value, truth.front, 0.15 * truth.front) << truth.friction;
    EXPECT_NEAR(found.cornering_rear.value, truth.rear, 0.15 * truth.rear) << truth.friction;
  }
}

TEST(TyreIdentification, FarFromTheLimitOnlyTheProductsAreFoundAndTheDeviationsSaySo) {
  const Truth truth{.speed = 2.5, .swing = 0.08, .duration = 20};
  const TyreIdentification slow = identify_tyres(drive(truth), {}, {});
  const TyreIdentification fast = identify_tyres(drive({.duration = truth.duration}), {}, {});
  EXPECT_GT(slow.friction.deviation, 5 * fast.friction.deviation);
  EXPECT_LT(slow.grip_used, fast.grip_used);
}

TEST(TyreIdentification, LeavesOutWhatCannotBe) {
  const Truth truth;
  auto samples = drive(truth);
  for (std::size_t i = 900; i < samples.size(); ++i) samples[i].x += 2;  // a jump of the localisation
  samples[1300].yaw = NAN;
  samples.erase(samples.begin() + 500, samples.begin() + 540);
  const TyreIdentification found = identify_tyres(samples, {}, {});
  EXPECT_NEAR(found.friction.value, truth.friction, 0.08 * truth.friction);
  EXPECT_NEAR(found.cornering_front.value, truth.front, 0.12 * truth.front);
}

TEST(TyreIdentification, RejectsTooLittleDataAndBadOptions) {
  auto samples = drive({.duration = 12});
  EXPECT_THROW(identify_tyres(samples, {}, {}, {.min_speed = 0}), std::invalid_argument);
  auto straight = samples;
  for (auto& s : straight) s.steer_command = 0.1;
  EXPECT_THROW(identify_tyres(straight, {}, {}), std::invalid_argument);
  samples.resize(300);
  EXPECT_THROW(identify_tyres(samples, {}, {}), std::invalid_argument);
  EXPECT_THROW(identify_tyres({}, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::vehicle::tyre_identification_test
