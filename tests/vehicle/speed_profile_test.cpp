// Speed profiles: known answers.
#include "slalom/vehicle/course/speed_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace slalom::vehicle {
namespace {

TEST(SpeedProfile, IsTheLateralLimitOnACircleAndTheTopSpeedOnALine) {
  const SpeedLimits limits;
  for (const double v : speed_profile(std::vector<double>(50, 0.5), 0.1, limits))
    EXPECT_NEAR(v, std::sqrt(limits.lateral_acceleration / 0.5), 1e-12);
  for (const double v : speed_profile(std::vector<double>(50, 0.0), 0.1, limits))
    EXPECT_EQ(v, limits.top_speed);
}

TEST(SpeedProfile, LeavesASlowPointAtTheLimitsOfMotorAndBrakes) {
  // One tight row on an otherwise straight closed path: v^2 grows by 2 a s to both sides (a is shared with
  // turning at the tight row itself, where all of the tyres' force is used).
  SpeedLimits limits{100, 4, 2, 3};
  std::vector<double> curvature(200, 0.0);
  curvature[120] = 4.0;
  const auto v = speed_profile(curvature, 0.1, limits);
  EXPECT_NEAR(v[120], 1.0, 1e-12);
  EXPECT_NEAR(v[121], 1.0, 1e-12);
  EXPECT_NEAR(v[119], 1.0, 1e-12);
  for (int k = 0; k < 60; ++k) EXPECT_NEAR(v[121 + k] * v[121 + k], 1 + 2 * 2 * 0.1 * k, 1e-9);
  for (int k = 0; k < 60; ++k) EXPECT_NEAR(v[119 - k] * v[119 - k], 1 + 2 * 3 * 0.1 * k, 1e-9);
}

TEST(SpeedProfile, RejectsLimitsThatAreNotPositive) {
  const std::vector<double> curvature(10, 0.1);
  EXPECT_THROW(speed_profile(curvature, 0.1, {0, 4, 2, 3}), std::invalid_argument);
  EXPECT_THROW(speed_profile(curvature, 0.1, {5, -4, 2, 3}), std::invalid_argument);
  EXPECT_THROW(speed_profile(curvature, 0.1, {5, 4, std::nan(""), 3}), std::invalid_argument);
  EXPECT_THROW(speed_profile(curvature, 0.1, {5, 4, 2, INFINITY}), std::invalid_argument);
  EXPECT_THROW(speed_profile(curvature, 0, {5, 4, 2, 3}), std::invalid_argument);
  EXPECT_THROW(speed_profile({0.1, std::nan(""), 0.1}, 0.1, {5, 4, 2, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::vehicle
