// Cars: profiles, configurations.
#include "slalom/vehicle/racing/racing_car.hpp"

#include "support/thrown_words.hpp"

namespace slalom::vehicle::racing_car_test {
namespace {

TEST(RacingSpeeds, AreInsideTheEllipseThroughoutAndNearFeasibleSpeeds) {
  RacingCar car{.max_steering_rate = 1e9, .limits = {7, 5, 3, 4}};
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
  RacingCar car{.max_steering_rate = 1e9, .limits = {60, 9, 9, 9}, .power = 40};
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

TEST(RacingSpeeds, ACurvatureThatIsNoNumberIsNoStraight) {
  const std::vector<double> curvature{0, std::nan(""), 0}, step(3, 1.0);
  EXPECT_EQ(message_of([&] { racing_speeds(curvature, step, true, {}); }),
            "curvature 1: .nan must be finite");
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
  for (const double friction : {0.0, 1e300, std::nan("")})
    EXPECT_THROW(set_friction(car, friction), std::invalid_argument);
  car.wheelbase = 1e-9;
  EXPECT_EQ(message_of([&] { validate(car); }), "wheelbase: 1e-09 must be within 0.01 to 100");
}

TEST(RacingCar, OfAConfigurationHasItsSizesAndTheGripOfItsPlans) {
  Configuration configuration;
  const RacingCar same = racing_car(configuration), known;
  EXPECT_EQ(same.width, known.width);
  EXPECT_EQ(same.wheelbase, known.wheelbase);
  EXPECT_EQ(same.max_steering_rate, known.max_steering_rate);
  EXPECT_EQ(same.limits.top_speed, known.limits.top_speed);
  auto& tyres = configuration.vehicle.own_of<SingleTrackOptions>();
  tyres.friction = 0.5;
  tyres.usable_grip = 0.8;
  configuration.vehicle.front_length = 1.2;
  configuration.vehicle.rear_length = 1.5;
  configuration.vehicle.body.margin = 0.3;
  configuration.vehicle.max_acceleration = 2;
  configuration.vehicle.max_deceleration = 9;
  configuration.planner.steer_limit = 0.5;
  configuration.planner.max_speed = 1;
  const RacingCar large = racing_car(configuration);
  EXPECT_NO_THROW(validate(large));
  EXPECT_DOUBLE_EQ(large.wheelbase, 2.7);
  EXPECT_EQ(large.max_steering, 0.5);
  EXPECT_DOUBLE_EQ(large.margin, 0.9);
  EXPECT_DOUBLE_EQ(large.limits.lateral_acceleration, 0.4 * 9.81);
  EXPECT_EQ(large.limits.acceleration, 2);
  EXPECT_DOUBLE_EQ(large.limits.braking, 0.4 * 9.81);
  EXPECT_EQ(large.limits.top_speed, racing_car("passenger").limits.top_speed) << "max_speed is for driving";
}

}  // namespace
}  // namespace slalom::vehicle::racing_car_test
