// Rollouts relative to a local origin: the cells of double, and UTM coordinates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "slalom/core/problem_evaluator.hpp"
#include "slalom/maps/reference_field.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "slalom/vehicle/published/options.hpp"
#include "solvers/closed_form.hpp"

namespace slalom::vehicle {
namespace {

/// m, what odometry and path are rounded to, so that they can be shifted without an error: 2^-24.
constexpr double step = 5.9604644775390625e-8;
double rounded(double x) {
  return step * std::round(x / step);
}

constexpr maps::Point utm{500000, 5000000};
constexpr double radius = 6;  // m, of the course

/// A circular course, counter-clockwise, its centre at `centre`.
std::vector<maps::ReferencePoint> circle(const maps::Point& centre) {
  std::vector<maps::ReferencePoint> path;
  constexpr int points = 377;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * M_PI * i / points;
    path.push_back({centre.x + rounded(radius * std::cos(angle)),
                    centre.y + rounded(radius * std::sin(angle)), angle + M_PI / 2, 3});
  }
  return path;
}

/// The ranges from `pose` (course centre at the origin) to two circular walls and a round post.
std::vector<float> scan_from(const maps::Pose& pose) {
  constexpr double post_x = -radius, post_y = 0.3, post_radius = 0.15;
  std::vector<float> ranges(541);
  const double x = pose.x + 0.275 * std::cos(pose.yaw), y = pose.y + 0.275 * std::sin(pose.yaw);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = pose.yaw - 2.35 + 4.7 / 540 * static_cast<double>(i);
    const double c = std::cos(angle), s = std::sin(angle);
    double range = 29;
    const auto meet = [&](double centre_x, double centre_y, double r) {
      const double along = (centre_x - x) * c + (centre_y - y) * s;
      const double across = (centre_x - x) * s - (centre_y - y) * c;
      if (std::abs(across) >= r) return;
      const double half = std::sqrt(r * r - across * across);
      for (const double distance : {along - half, along + half})
        if (distance > 0) range = std::min(range, distance);
    };
    meet(0, 0, radius - 1.2);
    meet(0, 0, radius + 1.2);
    meet(post_x, post_y, post_radius);
    ranges[i] = static_cast<float>(range);
  }
  return ranges;
}

Planner planner_of(bool published, const maps::Point& centre) {
  SvgMppiOptions method = testing::closed_form(1);
  method.samples = 512;
  method.input_min = -0.4;
  method.input_max = 0.4;
  method.seed = 3;
  return {published ? published::planner_options() : PlannerOptions{},
          make_vehicle_model(published ? published::vehicle_options() : VehicleOptions{}), circle(centre),
          make_solver(method, 1)};
}

class UtmLap : public ::testing::TestWithParam<bool> {};

/// The commands of a whole lap past an obstacle are the same bits, and the predictions are shifted.
TEST_P(UtmLap, IsTheLapNearTheOriginShifted) {
  Planner here = planner_of(GetParam(), {0, 0}), there = planner_of(GetParam(), utm);
  maps::Pose pose{radius, 0, M_PI / 2};
  double speed = 0, steer = 0, turned = 0;
  constexpr double period = 0.025;
  int ticks = 0;
  for (; turned < 2 * M_PI && ticks < 2000; ++ticks) {
    const maps::Pose seen{rounded(pose.x), rounded(pose.y), pose.yaw};
    const std::vector<float> ranges = scan_from(seen);
    const maps::LaserScanView scan{ranges, -2.35, 4.7 / 540, 0.05, 30};
    const PlannerOutput& a = here.update({scan, {seen, speed}});
    const PlannerOutput& b = there.update({scan, {{seen.x + utm.x, seen.y + utm.y, seen.yaw}, speed}});
    ASSERT_EQ(a.command.steer, b.command.steer) << "tick " << ticks;
    ASSERT_EQ(a.command.speed, b.command.speed) << "tick " << ticks;
    ASSERT_EQ(a.state_cost, b.state_cost) << "tick " << ticks;
    ASSERT_EQ(a.collision_cost, b.collision_cost) << "tick " << ticks;
    ASSERT_EQ(a.predicted.size(), b.predicted.size());
    for (std::size_t k = 0; k < a.predicted.size(); ++k) {
      ASSERT_NEAR(a.predicted[k].pose.x + utm.x, b.predicted[k].pose.x, 1e-9);
      ASSERT_NEAR(a.predicted[k].pose.y + utm.y, b.predicted[k].pose.y, 1e-9);
    }
    steer += (a.command.steer - steer) * 0.4;
    speed += std::clamp(a.command.speed - speed, -9 * period, 9 * period);
    const double before = std::atan2(pose.y, pose.x);
    pose.yaw += speed * period * std::tan(steer) / 0.33;
    pose.x += speed * period * std::cos(pose.yaw);
    pose.y += speed * period * std::sin(pose.yaw);
    turned += std::remainder(std::atan2(pose.y, pose.x) - before, 2 * M_PI);
  }
  EXPECT_GE(turned, 2 * M_PI) << "the car finishes the lap";
  EXPECT_GT(ticks, 300);
}

INSTANTIATE_TEST_SUITE_P(Configurations, UtmLap, ::testing::Bool(),
                         [](const auto& published) { return published.param ? "Published" : "Default"; });

/// A robot in the middle of a field with an even number of cells stands on an edge between cells, and which
/// of them it is in depends on the last bits of the position in double.
TEST(RelativeView, TheOriginIsInTheCellOfDoubleThoughItLiesOnAnEdge) {
  using F = Pack<simd::Generic>;
  std::mt19937 engine(1);
  for (const double reach : {10.0, 1000.0, 5e6}) {
    std::uniform_real_distribution<double> position(-reach, reach);
    const std::vector<float> cells(4 * 256 * 202);
    int other = 0;
    for (int i = 0; i < 2000; ++i) {
      const double x = position(engine), y = position(engine);
      const GridView<4> view(cells.data(), 200, 200, 8, 0.1, x, y), local = view.relative_to(x, y);
      EXPECT_EQ(local.index(F(0.0f), F(0.0f)).v[0], view.index(x, y)) << x << ", " << y;
      EXPECT_EQ(local.index(0.0, 0.0), view.index(x, y));
      other += view.index(F(static_cast<float>(x)), F(static_cast<float>(y))).v[0] != view.index(x, y);
    }
    EXPECT_GT(other, 0) << "without the local origin float32 picks other cells";
  }
}

/// Away from edges every position is in the cell of double, at any distance from the map's origin.
TEST(RelativeView, PositionsAwayFromEdgesAreInTheCellsOfDouble) {
  using F = Pack<simd::Generic>;
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> offset(-4, 4), within(0.01, 0.09);
  const std::vector<float> cells(4 * 256 * 202);
  const double x = 512345.678, y = 4987654.321;
  const GridView<4> view(cells.data(), 200, 200, 8, 0.1, x, y), local = view.relative_to(x, y);
  for (int i = 0; i < 10000; ++i) {
    const double dx = 0.1 * std::floor(10 * offset(engine)) + within(engine),
                 dy = 0.1 * std::floor(10 * offset(engine)) + within(engine);
    EXPECT_EQ(local.index(F(static_cast<float>(dx)), F(static_cast<float>(dy))).v[0],
              view.index(x + dx, y + dy));
  }
}

}  // namespace
}  // namespace slalom::vehicle
