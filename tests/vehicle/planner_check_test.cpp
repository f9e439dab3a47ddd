#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "slalom/solvers/registry.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "solvers/set_option.hpp"
#include "support/repetitions.hpp"

/// What leaves a planner is a command that a car may take, whatever enters it.
namespace slalom::vehicle {
namespace {

/// A straight lane along x, 60 m long.
std::vector<maps::ReferencePoint> lane(double speed) {
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < 600; ++i) path.push_back({0.1 * i, 0, 0, speed});
  return path;
}

SolverOptions few_samples(const char* method) {
  SolverOptions options = solver_options(method);
  testing::set(options, "horizon", 6);
  testing::set(options, "samples", 32);
  testing::set(options, "input_min", -0.4);
  testing::set(options, "input_max", 0.4);
  return options;
}

Planner make_planner(double max_speed) {
  PlannerOptions options;
  options.max_speed = max_speed;
  return {options, make_vehicle_model({}), lane(3), make_solver(few_samples("svg_mppi"), 1)};
}

/// A wall all round the car, `distance` m away.
std::vector<float> wall_around(float distance) {
  return std::vector<float>(271, distance);
}
maps::LaserScanView scan_of(const std::vector<float>& ranges) {
  return {ranges, -2.35, 4.7 / 270, 0.05, 30};
}

TEST(PlannerCheck, ASpeedThatNoCarHasIsNotTaken) {
  Planner planner = make_planner(8);
  const auto wall = wall_around(1.5F);
  for (const double speed : {4132.0, -4132.0, 1e300}) {
    const PlannerOutput& out = planner.update({scan_of(wall), {{5, 0, 0}, speed}});
    EXPECT_EQ(out.status, PlannerStatus::bad_odometry) << speed;
    EXPECT_EQ(out.command.speed, 0) << speed;
  }
  for (const double far : {1.1e7, -1e300}) {
    EXPECT_EQ(planner.update({scan_of(wall), {{far, 0, 0}, 1}}).status, PlannerStatus::bad_odometry) << far;
    EXPECT_EQ(planner.update({scan_of(wall), {{0, far, 0}, 1}}).status, PlannerStatus::bad_odometry) << far;
    EXPECT_EQ(planner.update({scan_of(wall), {{0, 0, far}, 1}}).status, PlannerStatus::bad_odometry) << far;
  }
}

TEST(PlannerCheck, BrakingStaysBelowTheLargestSpeed) {
  Planner planner = make_planner(8);
  const auto wall = wall_around(1.5F);
  const PlannerOutput& out = planner.update({scan_of(wall), {{5, 0, 0}, 150}});
  EXPECT_EQ(out.status, PlannerStatus::blocked);
  EXPECT_LE(out.command.speed, 8);
  EXPECT_EQ(out.corrections, 1);
}

/// Finite, of any magnitude, and now and then not.
class Adversary {
 public:
  explicit Adversary(std::uint64_t seed) : random_(seed) {}
  int below(int count) { return static_cast<int>(random_() % static_cast<std::uint64_t>(count)); }
  double within(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  double any(double low, double high) {
    static constexpr double odd[] = {0.0,    -0.0,   1e-310, 1e6,  -1e6,  1e7,    199.0,
                                     4132.0, -201.0, 1e38,   1e39, 1e300, -1e300, 1.7e308};
    switch (below(12)) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return below(2) ? INFINITY : -INFINITY;
      case 2:
        return odd[below(static_cast<int>(std::size(odd)))];
      default:
        return within(low, high);
    }
  }

 private:
  std::mt19937_64 random_;
};

maps::LaserScanView any_scan(Adversary& adversary, std::vector<float>& ranges) {
  ranges.resize(static_cast<std::size_t>(adversary.below(20) ? 40 : adversary.below(3000)));
  const bool walls = adversary.below(2) != 0;
  for (float& range : ranges)
    range = static_cast<float>(walls ? adversary.within(0.3, 4) : adversary.any(-1, 31));
  if (adversary.below(4)) return {ranges, -2.35, 0.12, 0.05, 30};
  return {ranges, adversary.any(-7, 7), adversary.any(-0.1, 0.1), adversary.any(-1, 1), adversary.any(0, 40)};
}

TEST(PlannerCheck, EveryCommandIsValidForAnyInput) {
  const long calls = testing::repetitions(20000);
  long made = 0, corrections = 0;
  long statuses[7] = {};
  for (std::uint64_t seed = 0; made < calls; ++seed) {
    Adversary adversary(seed);
    PlannerOptions options;
    options.max_speed = adversary.within(0.01, 20);
    options.steer_limit = adversary.within(0.01, 1.5);
    options.stop_when_blocked = adversary.below(4) != 0;
    options.verify_plan = adversary.below(4) != 0;
    options.back_up = adversary.below(2) != 0;
    options.published.maps = adversary.below(3) == 0;
    options.speed_lookahead = adversary.below(2) ? 0 : adversary.within(0, 2);
    VehicleOptions car;
    car.model = VehicleModelId{adversary.below(static_cast<int>(VehicleModels::size))};
    const auto methods = solver_names();
    const int inputs = input_count(car);
    const char* method = methods[static_cast<std::size_t>(adversary.below(static_cast<int>(methods.size())))];
    Planner planner(options, make_vehicle_model(car), lane(adversary.within(0, 30)),
                    make_solver(few_samples(method), inputs));
    std::vector<float> ranges;
    std::vector<maps::Point> points;
    for (int i = 0; i < 200; ++i, ++made) {
      const maps::LaserScanView scan = any_scan(adversary, ranges);
      points.resize(adversary.below(3) ? 0 : 3);
      for (maps::Point& point : points) point = {adversary.any(-5, 5), adversary.any(-5, 5)};
      const double most = adversary.below(8) ? 0.5 : 10;
      const bool hostile = adversary.below(4) == 0;
      const auto value = [&](double low, double high) {
        return hostile ? adversary.any(low, high) : adversary.within(low, high);
      };
      const Odometry odometry{{value(0, 60), most * value(-1, 1), value(-4, 4)}, value(-1, 12)};
      const PlannerOutput& out = planner.update({scan, odometry, points});
      SCOPED_TRACE("seed " + std::to_string(seed) + ", update " + std::to_string(i) + ", method " + method);
      ASSERT_LE(std::abs(out.command.steer), options.steer_limit);
      ASSERT_LE(out.command.speed, options.max_speed);
      ASSERT_GE(out.command.speed, -0.5);
      const bool stops = out.status == PlannerStatus::bad_scan || out.status == PlannerStatus::bad_odometry ||
                         out.status == PlannerStatus::off_course;
      if (stops) {
        ASSERT_EQ(out.command.speed, 0);
      }
      ASSERT_TRUE(std::isfinite(out.state_cost) && std::isfinite(out.collision_cost));
      ASSERT_TRUE(std::isfinite(out.steer_estimate));
      for (const float u : out.inputs) ASSERT_TRUE(std::isfinite(u));
      for (const PredictedState& s : out.predicted)
        ASSERT_TRUE(std::isfinite(s.pose.x) && std::isfinite(s.pose.y) && std::isfinite(s.speed));
      ++statuses[static_cast<int>(out.status)];
      corrections += out.corrections;
      if (!adversary.below(30)) planner.reset(seed);
    }
  }
  std::printf("[ calls    ] %ld updates, %ld corrections;", made, corrections);
  for (int i = 0; i < 7; ++i) std::printf(" %s %ld", name(static_cast<PlannerStatus>(i)), statuses[i]);
  std::printf("\n");
  for (int i = 0; i < 6; ++i) EXPECT_GT(statuses[i], 0) << name(static_cast<PlannerStatus>(i));
}

}  // namespace
}  // namespace slalom::vehicle
