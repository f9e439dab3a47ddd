#include "slalom/vehicle/planner/planner.hpp"

#include "support/lane.hpp"
#include "support/thrown_words.hpp"
#include "vehicle/planner/lane_scan.hpp"

namespace slalom::vehicle::planner_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const std::vector<maps::ReferencePoint> lane = testing::lane(3);

VehicleOptions small_car() {
  VehicleOptions options;
  options.body.model = BodyModel::box;
  options.cost.outside_cost = options.cost.outside_terminal_cost = 0;
  return options;
}

SvgMppiOptions few_samples() {
  SvgMppiOptions method = testing::few_steering_samples();
  method.seed = 7;
  return method;
}

Planner make_planner(const PlannerOptions& options = {}, const SvgMppiOptions& method = few_samples()) {
  return {options, make_vehicle_model(small_car()), lane, make_solver(method, 1)};
}

/// The scan in a corridor of half width 1.5 m round the lane with a wall across it `wall` m ahead of the
/// axle, which leaves a gap from `gap` m on to the left.
testing::LaneScan corridor(double wall = 100, double gap = 1.5, double y = 0) {
  std::vector<testing::Wall> walls = testing::beside_lane(1.5, y);
  walls.push_back({{wall, -1.5 - y}, {wall, gap - y}});
  return testing::LaneScan(walls);
}
const testing::LaneScan free_lane = corridor();

TEST(Planner, FollowsAFreeLaneAtItsSpeed) {
  // With few samples a plan's end is left to chance.
  SvgMppiOptions method = few_samples();
  method.samples = 4096;
  method.temperature = 0.1;
  method.variance_max = 0.003;
  method.guides.iterations = 20;
  for (method.seed = 0; method.seed < 20; ++method.seed) {
    Planner planner = make_planner({}, method);
    for (int i = 0; i < 5; ++i) {
      const PlannerOutput& out = planner.update({free_lane.view(), {{5, 0, 0}, 3}});
      EXPECT_EQ(out.status, PlannerStatus::ok);
      EXPECT_DOUBLE_EQ(out.command.speed, 3);
      ASSERT_EQ(out.predicted.size(), 21u);
      EXPECT_GT(out.predicted.back().pose.x, 7.5);
      EXPECT_LT(std::abs(out.predicted.back().pose.y), 0.3);
    }
  }
}

TEST(Planner, AGoalSpeedLimitsThatOfThePath) {
  Planner planner = make_planner(), told = make_planner();
  PlannerInput input{free_lane.view(), {{5, 0, 0}, 3}};
  for (const double goal : {1.5, nan, 0.5, -1.0, 7.0}) {
    input.goal_speed = goal;
    const double speed = planner.update({free_lane.view(), {{5, 0, 0}, 3}}).command.speed;
    EXPECT_DOUBLE_EQ(told.update(input).command.speed, goal > 0 ? std::min(goal, speed) : speed) << goal;
  }
}

TEST(Planner, SteersRoundAnObstacleOnTheSideThatIsFree) {
  Planner planner = make_planner();
  const testing::LaneScan scan = corridor(3, 0.1);
  for (int i = 0; i < 20; ++i) planner.update({scan.view(), {{5, 0, 0}, 3}});
  const PlannerOutput& out = planner.update({scan.view(), {{5, 0, 0}, 3}});
  double sideways = 0;
  for (const PredictedState& s : out.predicted) sideways = std::max(sideways, s.pose.y);
  EXPECT_GT(sideways, 0.2);
}

TEST(Planner, ObstaclesFromOutsideCountAsTheScansDo) {
  Planner planner = make_planner();
  std::vector<maps::Point> wall;
  for (double y = -1.5; y < 1.5; y += 0.04) wall.push_back({1.5, y});
  const PlannerOutput* out = nullptr;
  for (int i = 0; i < 5; ++i) out = &planner.update({free_lane.view(), {{5, 0, 0}, 3}, wall});
  EXPECT_EQ(out->status, PlannerStatus::blocked);
  EXPECT_LT(out->command.speed, 3);
}

TEST(Planner, BrakesWhereEveryPlanCollides) {
  Planner planner = make_planner();
  const testing::LaneScan scan = corridor(1.5);
  double speed = 3;
  for (int i = 0; i < 60; ++i) {
    const PlannerOutput& out = planner.update({scan.view(), {{5, 0, 0}, speed}});
    EXPECT_EQ(out.status, PlannerStatus::blocked);
    EXPECT_LE(out.command.speed, speed);
    speed = std::max(out.command.speed, 0.2);
  }
  EXPECT_LT(speed, 0.21);
}

TEST(Planner, WithTheAccelerationAsAnInputItIsFastWhereItCanAndSlowsDownInTime) {
  VehicleOptions car = small_car();
  car.model = vehicle_model("kinematic_acceleration");
  car.max_acceleration = car.max_deceleration = 6;
  SvgMppiOptions method = testing::closed_form(1);
  method.horizon = 20;
  method.samples = 1024;
  method.variance = {0.03, 4};
  method.guides.variance = method.guides.gradient_variance = {0.01, 4};
  method.guides.step = {0.005, 2};
  method.variance_min = {0.001, 0.5};
  method.variance_max = {0.1, 9};
  method.input_min = {-0.4, -6};
  method.input_max = {0.4, 6};
  method.seed = 7;
  // The car goes straight on at the speed it is told; a wall across the lane stands ahead.
  const auto drive = [&](double wall) {
    Planner planner({}, make_vehicle_model(car), lane, make_solver(method, 2));
    planner.reset(7);
    double x = 5, speed = 3;
    bool blocked = false;
    for (int i = 0; i < 120; ++i) {
      const testing::LaneScan scan = corridor(wall - x);
      const PlannerOutput& out = planner.update({scan.view(), {{x, 0, 0}, speed}});
      EXPECT_EQ(out.inputs_per_step, 2);
      EXPECT_EQ(out.inputs.size(), 40u);
      EXPECT_EQ(out.predicted.size(), 21u);
      blocked |= out.status == PlannerStatus::blocked;
      speed = std::clamp(out.command.speed, speed - 6 * 0.025, speed + 6 * 0.025);
      x += speed * 0.025;
    }
    return std::tuple{x, speed, blocked};
  };
  const auto [far, fast, free] = drive(1000);
  EXPECT_GT(fast, 2.7);
  EXPECT_FALSE(free);
  const auto [near, slow, blocked] = drive(8);
  EXPECT_LT(near, 8 - 0.461) << "the wall is not reached";
  EXPECT_LT(slow, 0.6);
  EXPECT_FALSE(blocked) << "a plan that slows down is free all the time";
}

TEST(Planner, CommandsAnglesAtWhichTheSteeringSettles) {
  VehicleOptions car = small_car();
  car.model = vehicle_model("single_track");
  SvgMppiOptions method = few_samples();
  method.variance = {0.03, 4};
  method.input_min = {-0.4, -6};
  method.input_max = {0.4, 6};
  PlannerOptions options{.steer_resolution = 0.05};
  Planner planner(options, make_vehicle_model(car), lane, make_solver(method, 2));
  double largest = 0;
  const testing::LaneScan scan = corridor(100, 1.5, 0.5);
  for (int i = 0; i < 10; ++i) {
    const double steer = planner.update({scan.view(), {{5 + 0.05 * i, 0.5, 0}, 2}}).command.steer;
    EXPECT_NEAR(steer / 0.05, std::round(steer / 0.05), 1e-9);
    EXPECT_LE(std::abs(steer), options.steer_limit);
    largest = std::max(largest, std::abs(steer));
  }
  EXPECT_GT(largest, 0.04) << "the car is beside the lane and steers";
}

TEST(Planner, ReversesFromAnObstacleInCollision) {
  for (const bool back_up : {true, false}) {
    PlannerOptions options{.back_up = back_up};
    Planner planner = make_planner(options);
    const testing::LaneScan scan = corridor(0.48);
    double slowest = 100;
    for (int i = 0; i < 40; ++i)
      slowest = std::min(slowest, planner.update({scan.view(), {{5, 0, 0}, 0}}).command.speed);
    EXPECT_EQ(slowest < 0, back_up);
  }
}

/// An input from which no plan can be made: a status, and a car that stops with its wheels held.
TEST(Planner, InvalidInputStopsTheCarAndValidInputRestartsIt) {
  const Odometry good{{5, 0, 0}, 3};
  const std::vector<float> nothing(271, std::numeric_limits<float>::infinity()),
      nonsense(271, std::numeric_limits<float>::quiet_NaN()), one(1, 2.0F), many(5000, 2.0F);
  const auto scan_of = [](const std::vector<float>& ranges) { return free_lane.view_of(ranges); };
  struct Case {
    const char* what;
    maps::LaserScanView scan;
    Odometry odometry;
    PlannerStatus status;
  };
  const maps::LaserScanView fine = free_lane.view();
  maps::LaserScanView turned = fine;
  turned.angle_min = nan;
  const std::vector<float> zeros(271, 0.0F);
  maps::LaserScanView dark = scan_of(zeros);
  dark.range_min = 0;
  const Case cases[] = {
      {"no ranges", {}, good, PlannerStatus::bad_scan},
      {"one range", scan_of(one), good, PlannerStatus::bad_scan},
      {"too many ranges", scan_of(many), good, PlannerStatus::bad_scan},
      {"only infinite ranges", scan_of(nothing), good, PlannerStatus::bad_scan},
      {"only NaN ranges", scan_of(nonsense), good, PlannerStatus::bad_scan},
      {"only zeros", dark, good, PlannerStatus::bad_scan},
      {"NaN angle", turned, good, PlannerStatus::bad_scan},
      {"NaN x", fine, {{nan, 0, 0}, 3}, PlannerStatus::bad_odometry},
      {"infinite y", fine, {{5, INFINITY, 0}, 3}, PlannerStatus::bad_odometry},
      {"NaN yaw", fine, {{5, 0, nan}, 3}, PlannerStatus::bad_odometry},
      {"NaN speed", fine, {{5, 0, 0}, nan}, PlannerStatus::bad_odometry},
      {"fast", fine, {{5, 0, 0}, 4132}, PlannerStatus::bad_odometry},
      {"fast backwards", fine, {{5, 0, 0}, -1e300}, PlannerStatus::bad_odometry},
      {"far x", fine, {{1.1e7, 0, 0}, 1}, PlannerStatus::bad_odometry},
      {"far y", fine, {{0, -1e300, 0}, 1}, PlannerStatus::bad_odometry},
      {"many turns", fine, {{0, 0, 1.1e7}, 1}, PlannerStatus::bad_odometry},
      {"far off the path", fine, {{5, 400, 0}, 3}, PlannerStatus::off_course},
  };
  Planner planner = make_planner();
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.what);
    ASSERT_EQ(planner.update({fine, good}).status, PlannerStatus::ok);
    const double held = planner.update({fine, good}).command.steer;
    const PlannerOutput& out = planner.update({bad.scan, bad.odometry});
    EXPECT_EQ(out.status, bad.status);
    EXPECT_EQ(out.command.speed, 0);
    EXPECT_TRUE(std::isfinite(out.command.steer));
    EXPECT_LE(std::abs(out.command.steer), std::abs(held) + 0.2);
    EXPECT_TRUE(out.inputs.empty());
  }
}

TEST(Planner, SomeBadRangesAreLeftOut) {
  testing::LaneScan scan = corridor();
  for (std::size_t i = 0; i < scan.ranges().size(); i += 3)
    scan.ranges()[i] = i % 2 ? std::numeric_limits<float>::quiet_NaN() : -1.0F;
  Planner planner = make_planner();
  const PlannerOutput& out = planner.update({scan.view(), {{5, 0, 0}, 3}});
  EXPECT_EQ(out.status, PlannerStatus::ok);
  EXPECT_EQ(out.scan.invalid, 91);
}

TEST(Planner, ResetMakesItNew) {
  const testing::LaneScan scan = corridor(3, 0.1);
  Planner planner = make_planner();
  const auto drive = [&] {
    planner.reset(11);
    std::vector<double> steers;
    for (int i = 0; i < 10; ++i) {
      steers.push_back(planner.update({scan.view(), {{5 + 0.05 * i, 0, 0}, 3}}).command.steer);
    }
    return steers;
  };
  EXPECT_EQ(drive(), drive());
}

TEST(Planner, RejectsInvalidArguments) {
  const auto refusal = [](const PlannerOptions& options, std::unique_ptr<VehicleModel> model,
                          const std::vector<maps::ReferencePoint>& path, std::unique_ptr<Solver> solver) {
    return message_of([&] { Planner(options, std::move(model), path, std::move(solver)); });
  };
  const auto car = [] { return make_vehicle_model(small_car()); };
  const auto solver = [](int inputs) { return make_solver(SvgMppiOptions{}, inputs); };
  EXPECT_EQ(refusal({}, car(), lane, nullptr), "planner: solver must not be null");
  EXPECT_EQ(refusal({}, nullptr, lane, solver(1)), "planner: model must not be null");
  EXPECT_EQ(refusal({}, car(), lane, solver(2)),
            "planner: solver has 2 inputs per step, must have 1, like the vehicle model");
  PlannerOptions slow{.latency = 0.9};
  EXPECT_EQ(refusal(slow, car(), lane, solver(1)),
            "planner.latency: together with vehicle.dead_time must be at most 32 control periods");
  EXPECT_NE(refusal({}, car(), {}, solver(1)), "accepted");
  EXPECT_EQ(refusal({}, car(), lane, solver(1)), "accepted");
}

}  // namespace
}  // namespace slalom::vehicle::planner_test
