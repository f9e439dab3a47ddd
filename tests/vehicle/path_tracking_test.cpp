#include "slalom/vehicle/model/path_tracking.hpp"

#include <gtest/gtest.h>

#include "slalom/vehicle/model/kinematic.hpp"
#include "slalom/vehicle/published/path_tracking.hpp"

namespace slalom::vehicle::path_tracking_test {
namespace {

/// Maps of 8 x 8 cells of 1 m round the origin: 2 m off a path along +x at 3 m/s, free of obstacles.
struct Maps {
  std::vector<float> reference = std::vector<float>(10 * 16 * 4), obstacles = std::vector<float>(10 * 16);
  Maps() {
    for (std::size_t i = 0; i < 160; ++i) {
      const bool ring = i / 16 == 0 || i / 16 == 9 || i % 16 == 0 || i % 16 >= 9;
      reference[4 * i] = ring ? 20.0f : 2.0f;
      reference[4 * i + 1] = ring ? 2.0f : 0.0f;
      reference[4 * i + 2] = ring ? 0.0f : 3.0f;
      reference[4 * i + 3] = ring ? 1.0f : 0.0f;
      obstacles[i] = ring ? -1.0f : 0.0f;
    }
  }
  template <class Problem>
  void give_to(Problem& problem, double x = 0, double y = 0, double yaw = 0) const {
    problem.set_maps({GridView<4>(reference.data(), 8, 8, 4, 1, 0, 0),
                      GridView<1>(obstacles.data(), 8, 8, 4, 1, 0, 0),
                      {x, y, yaw}});
  }
};

using KinematicProblem = PathTracking<Kinematic>;

/// A vehicle problem on these maps.
template <class Problem = KinematicProblem>
Problem on(const Maps& maps, const PathTrackingOptions& options) {
  Problem car(options);
  maps.give_to(car);
  return car;
}

// The cost map of a box holds the whole body, seen from the rear axle; the map of clearances holds a point.
TEST(ObstacleCost, LooksAheadOfTheRearAxleWithDiscsOnly) {
  BodyOptions body{.model = BodyModel::discs};
  EXPECT_NEAR(ObstacleCost(body).foremost(), 0.461 - 0.58 / 6, 1e-6);
  body.model = BodyModel::box;
  EXPECT_EQ(ObstacleCost(body).foremost(), 0);
}

TEST(PathTracking, RearAxleDrivesTheCircleOfItsSteeringAngle) {
  PathTrackingOptions options{.time_step = 0.001, .speed = SpeedModel::constant};
  const Maps maps;
  const KinematicProblem car = on(maps, options);
  const double steer = 0.3, radius = 0.3302 / std::tan(steer);
  KinematicProblem::State<double> s{0, 0, 0, 1, steer, 0};
  const double turn = 1.0 / radius;  // after 1 s at 1 m/s
  for (int k = 0; k < 1000; ++k) s = car.step(s, car.look_up(s), Input<double, 1>{{steer}}, k);
  EXPECT_NEAR(s.yaw, turn, 1e-9);
  EXPECT_NEAR(s.x, radius * std::sin(turn), 1e-3);
  EXPECT_NEAR(s.y, radius * (1 - std::cos(turn)), 1e-3);
}

TEST(TrackingCost, ForTheLapTimeSpeedAboveThePathsIsTimeWon) {
  PathTrackingOptions options{.cost = {.speed_weight = 30}};
  const auto lost = [&](bool lap_time, double speed, double outside) {
    TrackingCost cost(options);
    if (lap_time) cost.set_lap_time();
    return cost.with_time_lost(Cost<double>{0, false}, 0.0, speed, Surroundings<double>{0, 0, 4, outside, 0})
        .value;
  };
  for (const bool lap_time : {false, true}) {
    EXPECT_NEAR(lost(lap_time, 3, 0), 30 * 0.25, 1e-9);
    EXPECT_NEAR(lost(lap_time, 4, 0), 0, 1e-9);
    // Outside of a curve, where 3 m are 2 m of the path.
    EXPECT_NEAR(lost(lap_time, 3, -2.0 / 3), 30 * 0.5, 1e-9);
  }
  EXPECT_EQ(lost(false, 5, 0), 0);
  EXPECT_NEAR(lost(true, 5, 0), -30 * 0.25, 1e-9);
}

TEST(PublishedVehicle, YawGainIsTooHighBy42Percent) {
  const Maps maps;
  const auto yaw_gain = [&](auto car) {
    maps.give_to(car);
    const typename decltype(car)::template State<double> s{0, 0, 0, 1, 1e-4, 0};
    return (car.step(s, car.look_up(s), Input<double, 1>{{0}}, 0).yaw - s.yaw) /
           (car.options().time_step * s.speed * s.steer);
  };
  PathTrackingOptions lengths{.front_length = 0.189, .rear_length = 0.135};
  EXPECT_NEAR(yaw_gain(published::OneTrajectory(lengths, published::ModelOptions::published())), 4.32, 0.005);
  EXPECT_NEAR(yaw_gain(KinematicProblem(PathTrackingOptions{})), 3.03, 0.005);
}

TEST(PathTracking, CostIsThatOfDistanceYawAndCollision) {
  PathTrackingOptions options;
  options.cost.distance_weight = 3;
  options.cost.yaw_weight = 0.5;
  options.cost.collision_weight = 2;
  options.cost.outside_cost = 70;
  options.cost.outside_terminal_cost = 11;
  options.body.model = BodyModel::box;
  const Maps maps;
  const KinematicProblem car = on(maps, options);
  const KinematicProblem::State<double> inside{0.2, 0.3, 6.5, 1, 0, 0}, outside{50, 0, 1, 1, 0, 0};
  const Input<double, 1> u{{0}};
  const double error = 6.5 - 2 * std::acos(-1.0);
  EXPECT_NEAR(car.stage_cost(inside, car.look_up(inside), u).value, 3 * 4 + 0.5 * error * error, 1e-12);
  EXPECT_FALSE(car.stage_cost(inside, car.look_up(inside), u).collided);
  EXPECT_NEAR(car.stage_cost(outside, car.look_up(outside), u).value, 3 * 400 + 0.5 * 4 + 2 * 70, 1e-12);
  EXPECT_NEAR(car.terminal_cost(outside, car.look_up(outside)).value, 400 + 0.01 * 4 + 2 * 11, 1e-12);
  EXPECT_TRUE(car.stage_cost(outside, car.look_up(outside), u).collided);
}

TEST(PathTracking, SpeedFollowsTheReferenceWithinItsLimits) {
  PathTrackingOptions options{.max_acceleration = 4, .max_deceleration = 2};
  const Maps maps;
  const KinematicProblem car = on(maps, options);
  const auto next_speed = [&](double speed) {
    const KinematicProblem::State<double> s{0, 0, 0, speed, 0, 0};
    return car.step(s, car.look_up(s), Input<double, 1>{{0}}, 0).speed;
  };
  EXPECT_NEAR(next_speed(1), 1.2, 1e-12);
  EXPECT_NEAR(next_speed(2.9), 3, 1e-12);
  EXPECT_NEAR(next_speed(5), 4.9, 1e-12);
}

TEST(PathTracking, AccelerationAsAnInputStaysWithinTheCarsLimitsAndThePathsSpeed) {
  PathTrackingOptions options;
  options.max_acceleration = 4;
  options.max_deceleration = 2;
  options.cost.speed_weight = 0.5;
  options.body.model = BodyModel::box;
  const Maps maps;  // 3 m/s, 2 m off the path
  const auto car = on<PathTracking<KinematicAcceleration>>(maps, options);
  const auto at = [](double speed) {
    return PathTracking<KinematicAcceleration>::State<double>{0, 0, 0, speed, 0, 0};
  };
  const auto next_speed = [&](double speed, double acceleration) {
    return car.step(at(speed), car.look_up(at(speed)), Input<double, 2>{{0, acceleration}}, 0).speed;
  };
  EXPECT_NEAR(next_speed(1, 2), 1.1, 1e-12);
  EXPECT_NEAR(next_speed(1, 100), 1.2, 1e-12);
  EXPECT_NEAR(next_speed(1, -1), 0.95, 1e-12);
  EXPECT_NEAR(next_speed(1, -100), 0.9, 1e-12);
  EXPECT_NEAR(next_speed(2.95, 4), 3, 1e-12) << "the path's speed is the limit";
  EXPECT_NEAR(next_speed(5, 4), 4.9, 1e-12) << "and is come down to as brakes allow";
  EXPECT_NEAR(next_speed(0.05, -2), 0, 1e-12) << "never backwards";
  const auto cost = [&](double speed) {
    return car.stage_cost(at(speed), car.look_up(at(speed)), Input<double, 2>{}).value;
  };
  EXPECT_NEAR(cost(3), 4, 1e-12);
  EXPECT_NEAR(cost(1), 4 + 0.5 * 4, 1e-12);
  EXPECT_NEAR(cost(5), 4, 1e-12) << "too fast is the model's to forbid";
}

TEST(PathTracking, LocalPositionIsThatInTheRobotsFrame) {
  Maps maps;
  maps.obstacles[3 * 16 + 4] = 100;  // x in (1, 2], y in (0, 1], robot frame
  PathTrackingOptions options{.body = {.model = BodyModel::box}};
  KinematicProblem car(options);
  maps.give_to(car, 10, -5, std::acos(-1.0) / 2);  // the robot looks along +y of the map
  const KinematicProblem::State<double> hit{10 - 0.5, -5 + 1.5, 0, 1, 0, 0},
      free{10 + 0.5, -5 + 1.5, 0, 1, 0, 0};
  EXPECT_EQ(car.look_up(hit).obstacle, 100);
  EXPECT_EQ(car.look_up(free).obstacle, 0);
}

TEST(PathTracking, DiscsTurnWithTheCar) {
  Maps maps;
  // Distances instead of costs: 2 m everywhere, but none where x in (1, 2], y in (0, 1].
  for (float& cell : maps.obstacles) cell = cell < 0 ? -1.0f : 2.0f;
  maps.obstacles[3 * 16 + 4] = 0;
  PathTrackingOptions options{.body = {.model = BodyModel::discs, .front = 1.2, .rear = 0}};
  const KinematicProblem car = on(maps, options);
  const KinematicProblem::State<double> towards{0.5, 0.5, 0, 1, 0, 0},
      away{0.5, 0.5, std::acos(-1.0), 1, 0, 0};
  EXPECT_EQ(car.look_up(towards).obstacle, 100);
  EXPECT_EQ(car.look_up(away).obstacle, 0);
  const Input<double, 1> u{{0}};
  EXPECT_TRUE(car.stage_cost(towards, car.look_up(towards), u).collided);
  EXPECT_FALSE(car.stage_cost(away, car.look_up(away), u).collided);
}

TEST(PathTracking, SmallClearanceCostsBeforeACollision) {
  PathTrackingOptions options{.body = {.model = BodyModel::discs, .soft_cost = 8}};
  const double radius = std::hypot((options.body.front + options.body.rear) / 6, options.body.width / 2);
  const auto value_at = [&](double clearance) {
    Maps maps;
    for (float& cell : maps.obstacles) cell = cell < 0 ? -1.0f : static_cast<float>(clearance);
    return on(maps, options).look_up(KinematicProblem::State<double>{0, 0, 0, 1, 0, 0}).obstacle;
  };
  EXPECT_EQ(value_at(radius + options.body.margin - 0.01), 100);
  EXPECT_NEAR(value_at(radius + options.body.margin + 0.5 * options.body.soft_margin), 8 * 0.25, 1e-4);
  EXPECT_EQ(value_at(radius + options.body.margin + options.body.soft_margin + 0.01), 0);
}

}  // namespace
}  // namespace slalom::vehicle::path_tracking_test
