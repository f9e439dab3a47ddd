// Cars: limits that depend on the speed, profiles, files.
#include "slalom/vehicle/racing/racing_car.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom::vehicle {
namespace {

class RacingCarFile : public testing::TemporaryFolder {};

TEST(RacingSpeeds, AreInsideTheEllipseThroughoutAndNearFeasibleSpeeds) {
  RacingCar car;
  car.limits = {7, 5, 3, 4};
  car.max_steering_rate = 1e9;
  constexpr std::size_t count = 300;
  std::vector<double> curvature, step;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<double>(i);
    curvature.push_back(0.8 * std::sin(0.07 * at) * std::sin(0.013 * at));
    step.push_back(0.1 + 0.05 * std::cos(at));
  }
  const auto most_used = [&](const std::vector<double>& speeds, bool closed) {
    double most = 0;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i) {
      const std::size_t next = (i + 1) % count;
      const double v = speeds[i], w = speeds[next], along = (w * w - v * v) / (2 * step[i]);
      const double strongest = along > 0 ? car.limits.acceleration : car.limits.braking;
      const auto used = [&](double speed, double k) {
        return std::hypot(speed * speed * k / car.limits.lateral_acceleration, along / strongest);
      };
      most = std::max({most, used(v, curvature[i]), used(w, curvature[next]),
                       used(0.5 * (v + w), 0.5 * (curvature[i] + curvature[next]))});
    }
    return most;
  };
  for (const bool closed : {true, false}) {
    const auto speeds = racing_speeds(curvature, step, closed, car);
    const auto others = feasible_speeds(std::vector<double>(count, 7), curvature, step, closed, car.limits);
    EXPECT_LT(most_used(speeds, closed), 1 + 1e-9);
    EXPECT_GT(most_used(others, closed), 1.05) << "the limits of the begin of a piece are not enough";
    for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(speeds[i], others[i], 0.01 * others[i]) << i;
  }
}

TEST(RacingSpeeds, PowerLimitsTheGainOfEnergy) {
  // One slow point on a straight: the kinetic energy per mass, v^2 / 2, grows by power in time.
  RacingCar car;
  car.limits = {60, 9, 9, 9};
  car.power = 40;
  car.max_steering_rate = 1e9;
  std::vector<double> curvature(4000, 0.0), step(4000, 0.05);
  curvature[0] = 9;
  const auto v = racing_speeds(curvature, step, false, car);
  double time = 0;
  std::size_t i = 0;
  for (; v[i] < 6; ++i) {
  }
  const double begin = v[i];
  for (std::size_t k = i; k < 1500; ++k) time += 2 * step[k] / (v[k] + v[k + 1]);
  EXPECT_NEAR(0.5 * (v[1500] * v[1500] - begin * begin), 40 * time, 0.01 * 40 * time);
}

TEST(RacingSpeeds, LateralGripMayDependOnTheSpeed) {
  RacingCar car;
  car.limits.top_speed = 30;
  car.grip = {{0, 8, 8, 4}, {10, 8, 8, 4}, {20, 4, 8, 12}};
  EXPECT_DOUBLE_EQ(grip_at(car, 15).lateral, 8);
  EXPECT_DOUBLE_EQ(grip_at(car, 15).acceleration, 6);
  EXPECT_DOUBLE_EQ(grip_at(car, 30).lateral, 12);
  const std::vector<double> step(50, 1.0);
  EXPECT_NEAR(racing_speeds(std::vector<double>(50, 0.16), step, true, car)[7], 5, 1e-9);
}

TEST(RacingSpeeds, SteeringTakesTime) {
  // A step of the curvature by 0.5 1/m over 0.1 m: v 0.5 / 0.1 * wheelbase <= rate.
  RacingCar car;
  std::vector<double> curvature(100, 0.0);
  for (std::size_t i = 50; i < 100; ++i) curvature[i] = 0.5;
  const auto v = racing_speeds(curvature, std::vector<double>(100, 0.1), false, car);
  EXPECT_NEAR(v[49], car.max_steering_rate * 0.1 / (0.5 * car.wheelbase), 1e-9);
}

TEST(RacingCar, IsKnownByName) {
  for (const std::string& name : racing_car_names()) {
    EXPECT_EQ(racing_car(name).name, name);
    EXPECT_NO_THROW(validate(racing_car(name)));
  }
  EXPECT_THROW(racing_car("tank"), std::invalid_argument);
  RacingCar car;
  set_friction(car, 0.5);
  EXPECT_DOUBLE_EQ(car.limits.braking, 4.905);
  EXPECT_THROW(set_friction(car, 0), std::invalid_argument);
}

TEST_F(RacingCarFile, SetsWhatItNames) {
  const auto file =
      write("kart.yaml", "base: passenger\nwidth: 1.4\npower: 60\nggv: [[0, 6, 8, 9], [30, 3, 8, 9.5]]\n");
  const RacingCar car = load_racing_car(file);
  EXPECT_EQ(car.name, "kart");
  EXPECT_EQ(car.width, 1.4);
  EXPECT_EQ(car.power, 60);
  EXPECT_EQ(car.wheelbase, racing_car("passenger").wheelbase);
  ASSERT_EQ(car.grip.size(), 2u);
  EXPECT_EQ(car.grip[1].acceleration, 3);
}

TEST_F(RacingCarFile, SaysWhatIsWrongAndWhere) {
  const std::pair<const char*, std::vector<const char*>> cases[] = {
      {"width: 0.3\nwidht: 1\n", {"car.yaml:2", "widht", "unknown key", "wheelbase"}},
      {"width: -1\n", {"car.yaml:1", "width", "'-1'", "above 0"}},
      {"base: tank\n", {"car.yaml:1", "base", "tank", "f1tenth"}},
      {"ggv: [[0, 1, 2]]\n", {"car.yaml:1", "ggv", "rows"}},
      {"ggv: [[5, 8, 8, 8], [5, 8, 8, 8]]\n", {"car.yaml:1", "rising speed"}},
      {"max_steering: 2\n", {"max_steering", "1.5"}},
      {"- 1\n", {"car.yaml:1", "keys"}}};
  for (const auto& [text, says] : cases) {
    SCOPED_TRACE(text);
    expect_error_with<IoError>(says, [&, text = text] { load_racing_car(write("car.yaml", text)); });
  }
}

}  // namespace
}  // namespace slalom::vehicle
