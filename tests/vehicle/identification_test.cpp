// Results of identify for cars whose steering is known.
#include "slalom/vehicle/model/identification.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "slalom/core/random.hpp"

namespace slalom::vehicle::identification_test {
namespace {

struct Truth {
  double gain = 0.93, offset = 0.012, delay = 0.047, lag = 0.085, wheelbase = 0.324, understeer = 0.004;
};

/// A minute of wavy driving by the model, in Euler steps, sampled every 25 ms with noise of the yaw (rad).
std::vector<DrivenSample> drive(const Truth& car, double yaw_noise, double speed_scale = 1) {
  RandomStream random({7, 0});
  std::vector<DrivenSample> samples;
  double x = 0, y = 0, yaw = 0, steer = 0;
  std::vector<std::pair<double, double>> sent;
  constexpr double dt = 0.0005;
  for (int i = 0; i < 120000; ++i) {
    const double t = i * dt, speed = 2.5 + 1.5 * std::sin(0.4 * t);
    if (i % 50 == 0) {
      const double command = 0.25 * std::sin(1.9 * t) + 0.14 * std::sin(5.3 * t + 1);
      samples.push_back({t, x, y, yaw + yaw_noise * random.normal(), speed / speed_scale, command});
      sent.emplace_back(t + car.delay, command);
    }
    double acting = sent.front().second;
    for (auto it = sent.rbegin(); it != sent.rend(); ++it) {
      if (it->first > t) continue;
      acting = it->second;
      break;
    }
    steer += dt / car.lag * (car.gain * acting + car.offset - steer);
    yaw += dt * speed * std::tan(steer) / (car.wheelbase + car.understeer * speed * speed);
    x += dt * speed * std::cos(yaw);
    y += dt * speed * std::sin(yaw);
  }
  return samples;
}

TEST(Identification, FindsAllWithoutNoise) {
  const Truth car;
  const Identification found = identify(drive(car, 0));
  EXPECT_NEAR(found.steering_gain.value, car.gain, 0.01);
  EXPECT_NEAR(found.steering_offset.value, car.offset, 0.0005);
  EXPECT_NEAR(found.delay.value, car.delay, 0.002);
  EXPECT_NEAR(found.time_constant.value, car.lag, 0.002);
  EXPECT_NEAR(found.wheelbase.value, car.wheelbase, 0.004);
  EXPECT_NEAR(found.understeer.value, car.understeer, 0.0005);
  EXPECT_GT(found.explained, 0.999);
}

TEST(Identification, EstimatesTheSteeringOfANoisyDriveForAKnownWheelbase) {
  const Truth car;
  const Identification found = identify(drive(car, 0.004), {.wheelbase = car.wheelbase});
  EXPECT_NEAR(found.steering_gain.value, car.gain, 0.02);
  EXPECT_NEAR(found.delay.value, car.delay, 0.006);
  EXPECT_NEAR(found.time_constant.value, car.lag, 0.008);
  EXPECT_EQ(found.wheelbase.value, car.wheelbase);
  EXPECT_EQ(found.wheelbase.deviation, 0);
}

TEST(Identification, DeviationsCoverTheErrors) {
  const Truth car;
  const Identification found = identify(drive(car, 0.004));
  const auto covers = [](const Identified& value, double truth) {
    return std::abs(value.value - truth) < 5 * value.deviation;
  };
  EXPECT_TRUE(covers(found.steering_gain, car.gain))
      << found.steering_gain.value << " +- " << found.steering_gain.deviation;
  EXPECT_TRUE(covers(found.wheelbase, car.wheelbase))
      << found.wheelbase.value << " +- " << found.wheelbase.deviation;
  EXPECT_TRUE(covers(found.delay, car.delay)) << found.delay.value << " +- " << found.delay.deviation;
  EXPECT_GT(found.wheelbase.deviation, 5e-4) << "noise must show";
}

TEST(Identification, ComparesSpeedWithDistance) {
  EXPECT_NEAR(identify(drive({}, 0, 1.04), {.wheelbase = 0.324}).speed_scale, 1.04, 0.005);
}

TEST(Identification, SplitsAtGapsAndLaps) {
  const Truth car;
  auto samples = drive(car, 0);
  const auto again = samples;
  samples.insert(samples.end(), again.begin(), again.end());  // time goes back
  samples[700].yaw = NAN;
  samples.erase(samples.begin() + 300, samples.begin() + 320);
  const Identification found = identify(samples, {.wheelbase = car.wheelbase});
  EXPECT_NEAR(found.delay.value, car.delay, 0.002);
  EXPECT_NEAR(found.time_constant.value, car.lag, 0.002);
}

TEST(Identification, RejectsTooLittleData) {
  auto samples = drive({}, 0);
  for (auto& s : samples) s.steer_command = 0.1;
  EXPECT_THROW(identify(samples), std::invalid_argument);
  samples.resize(100);
  EXPECT_THROW(identify(samples), std::invalid_argument);
  EXPECT_THROW(identify({}), std::invalid_argument);
  EXPECT_THROW(identify(samples, {.wheelbase = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::vehicle::identification_test
