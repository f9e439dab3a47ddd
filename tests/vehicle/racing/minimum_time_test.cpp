// The minimum-time line: known answers, limits, optimality, errors.
#include "slalom/vehicle/racing/minimum_time.hpp"

#include <random>

#include "slalom/vehicle/course/raceline.hpp"
#include "support/thrown_words.hpp"
#include "vehicle/course/curve.hpp"
#include "vehicle/racing/rooms.hpp"

namespace slalom::vehicle::minimum_time_test {
namespace {

using namespace testing;

/// A closed corridor with bends of both directions and of several radii.
Corridor winding(double half_width) {
  std::vector<maps::Point> points;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * pi * i / 400, radius = 8 + 2.2 * std::sin(3 * angle) + 0.8 * std::cos(5 * angle);
    points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  const std::vector<double> widths(points.size(), half_width);
  return corridor_from_widths(points, widths, widths, true, 0.15);
}

double offset(const Corridor& corridor, const Raceline& line, std::size_t i) {
  return (line.points[i].x - corridor.centre_line[i].x) * corridor.normal[i].x +
         (line.points[i].y - corridor.centre_line[i].y) * corridor.normal[i].y;
}

/// The time along a line of offsets with the fastest speeds.
double time_of(const Corridor& corridor, const std::vector<double>& offsets, const RacingCar& car) {
  using namespace detail;  // the operators of points
  const std::size_t n = offsets.size();
  Curve line;
  for (std::size_t i = 0; i < n; ++i)
    line.push_back(corridor.centre_line[i] + offsets[i] * corridor.normal[i]);
  std::vector<double> step;
  for (std::size_t i = 0; i < n; ++i) step.push_back(distance(line[i], line[(i + 1) % n]));
  const auto curvature = detail::curvature(line, 1);
  const auto speed = racing_speeds(curvature, step, true, car);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += 2 * step[i] / (speed[i] + speed[(i + 1) % n]);
  return sum;
}

/// The squares of the second differences of a line of offsets, the objective of minimum_curvature_offsets().
double bending(const std::vector<maps::Point>& points, const std::vector<double>& offsets) {
  using namespace detail;
  const Curve normal = normals(points);
  const std::size_t n = points.size();
  const auto at = [&](std::size_t i) { return points[i % n] + offsets[i % n] * normal[i % n]; };
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const maps::Point bend = at(i) - 2 * at(i + 1) + at(i + 2);
    sum += dot(bend, bend);
  }
  return sum;
}

TEST(LeastCurvature, IsOptimalWithinItsBounds) {
  for (const double bound : {0.0, 0.6}) {
    const auto points = winding(1).centre_line;
    auto offsets = minimum_curvature_offsets(points, bound);
    const double best = bending(points, offsets);
    EXPECT_EQ(best<bending(points, std::vector<double>(points.size(), 0.0)), bound> 0);
    for (double& offset : offsets) {
      ASSERT_LE(std::abs(offset), bound);
      const double kept = offset;
      for (const double move : {-1e-3, 1e-3}) {
        offset = std::clamp(kept + move, -bound, bound);
        EXPECT_GE(bending(points, offsets), best - 1e-9);
      }
      offset = kept;
    }
  }
  for (const double offset : minimum_curvature_offsets(circle(5, 1).centre_line, 0.7))
    EXPECT_NEAR(offset, 0.7, 1e-5) << "the whole line moves to the inside";
  for (const double bound : {-0.1, std::nan("")})
    EXPECT_THROW(minimum_curvature_offsets(circle(5, 1).centre_line, bound), std::invalid_argument);
  EXPECT_THROW(minimum_curvature_offsets(std::vector<maps::Point>(7), 0.5), std::invalid_argument);
}

TEST(MinimumTime, OnACircleItIsTheInnerBound) {
  // v = sqrt(a r), so a lap takes 2 pi sqrt(r / a): the smallest radius is the fastest.
  const RacingCar car;
  const Raceline line = minimum_time_raceline(circle(5, 1), car);
  const double radius = 5 - 1 + wall_distance(car, 2);
  EXPECT_NEAR(line.time, 2 * pi * std::sqrt(radius / car.limits.lateral_acceleration), 0.01);
  for (const RacelinePoint& point : line.points) EXPECT_NEAR(std::hypot(point.x, point.y), radius, 0.01);
}

TEST(MinimumTime, KeepsTheMarginWhereItFitsAndLessInANarrowPlace) {
  const RacingCar car;
  Corridor corridor = circle(5, 1);
  const std::size_t narrow = corridor.left.size() / 2;
  corridor.left[narrow] = corridor.right[narrow] = 0.24;
  const Raceline line = minimum_time_raceline(corridor, car);
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const double keep = 0.5 * car.width + (i == narrow ? least_margin_share : 1) * car.margin;
    EXPECT_LE(offset(corridor, line, i), corridor.left[i] - keep) << i;
    EXPECT_GE(offset(corridor, line, i), keep - corridor.right[i]) << i;
  }
}

TEST(MinimumTime, TheMarginIsAQuarterOfTheRoomBesideTheCarBetweenItsLimits) {
  const RacingCar car;
  for (const auto& [room, margin] :
       {std::pair(0.0, 0.06), {0.24, 0.06}, {0.4, 0.1}, {0.6, 0.15}, {2.0, 0.15}})
    EXPECT_DOUBLE_EQ(wall_distance(car, car.width + room), 0.5 * car.width + margin) << room;
}

TEST(MinimumTime, OnAnOpenStraightItIsStraightAtTheTopSpeed) {
  const RacingCar car;
  const Raceline line = minimum_time_raceline(straight(40, 0.8), car);
  EXPECT_FALSE(line.closed);
  EXPECT_NEAR(line.time, 40 / car.limits.top_speed, 0.01);
  for (const RacelinePoint& point : line.points) EXPECT_NEAR(point.speed, car.limits.top_speed, 1e-9);
}

TEST(MinimumTime, StaysInTheCorridorAndWithinTheLimits) {
  RacingCar car{.limits = {9, 7, 4, 6}, .power = 25};
  const Corridor corridor = winding(1.1);
  const Raceline line = minimum_time_raceline(corridor, car);
  const std::size_t n = line.points.size();
  ASSERT_EQ(n, corridor.centre_line.size());
  EXPECT_EQ(line.curvature_limit, max_curvature(car));
  double time = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const RacelinePoint &here = line.points[i], &next = line.points[(i + 1) % n];
    const double step = std::hypot(next.x - here.x, next.y - here.y);
    EXPECT_LE(std::abs(offset(corridor, line, i)), 1.1 - wall_distance(car, 2.2));
    EXPECT_LE(std::abs(here.curvature), max_curvature(car));
    EXPECT_LE(here.speed, car.limits.top_speed);
    EXPECT_LE(here.speed * here.speed * std::abs(here.curvature),
              car.limits.lateral_acceleration * (1 + 1e-9));
    EXPECT_LE(here.acceleration * here.speed, car.power * (1 + 1e-9));
    EXPECT_LE(here.acceleration, car.limits.acceleration * (1 + 1e-9));
    EXPECT_GE(here.acceleration, -car.limits.braking * (1 + 1e-9));
    EXPECT_LE(here.speed * std::abs(next.curvature - here.curvature) * car.wheelbase / step,
              car.max_steering_rate * (1 + 1e-9));
    time += 2 * step / (here.speed + next.speed);
  }
  EXPECT_NEAR(line.time, time, 1e-9);
}

TEST(MinimumTime, IsFasterThanTheLineOfLeastCurvature) {
  const RacingCar car;
  const Corridor corridor = winding(1.1);
  const auto min_curvature = minimum_curvature_offsets(corridor.centre_line, 1.1 - wall_distance(car, 2.2));
  EXPECT_LT(minimum_time_raceline(corridor, car).time, time_of(corridor, min_curvature, car));
}

TEST(MinimumTime, NoSmoothChangeOfTheLineIsFaster) {
  const RacingCar car;
  const Corridor corridor = winding(0.9);
  const Raceline line = minimum_time_raceline(corridor, car);
  const std::size_t n = line.points.size();
  const double bound = 0.9 - wall_distance(car, 1.8);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 60; ++trial) {
    const double middle = uniform(random) * static_cast<double>(n), size = 0.03 * uniform(random),
                 reach = 8 + 20 * std::abs(uniform(random));
    std::vector<double> changed;
    for (std::size_t i = 0; i < n; ++i) {
      const double away = std::remainder(static_cast<double>(i) - middle, static_cast<double>(n)) / reach;
      changed.push_back(std::clamp(offset(corridor, line, i) + size * std::exp(-away * away), -bound, bound));
    }
    EXPECT_GE(time_of(corridor, changed, car), line.time * (1 - 3e-4)) << trial;
  }
}

TEST(MinimumTime, ObeysTheSteeringWhereTheCentreLineDoesNot) {
  // A right angle: the centre line turns on the spot, the widths allow an arc.
  std::vector<maps::Point> points;
  for (int i = 0; i <= 30; ++i) points.push_back({0.2 * i - 6, 0});
  for (int i = 1; i <= 30; ++i) points.push_back({0, 0.2 * i});
  const std::vector<double> widths(points.size(), 1.0);
  const RacingCar car;
  const Raceline line = minimum_time_raceline(corridor_from_widths(points, widths, widths, false, 0.15), car);
  EXPECT_EQ(line.curvature_limit, max_curvature(car));
  for (const RacelinePoint& point : line.points) EXPECT_LE(std::abs(point.curvature), max_curvature(car));
}

TEST(MinimumTime, SaysWhatCurvatureANarrowCornerForces) {
  RacingCar car;
  car.wheelbase = 3;  // turns a radius of 7 m
  const Raceline line = minimum_time_raceline(circle(4, 0.6), car);
  EXPECT_GT(line.curvature_limit, max_curvature(car));
  EXPECT_GT(line.curvature_limit, 1 / 4.6);
  EXPECT_LT(line.curvature_limit, 1.1 / 3.8);
}

TEST(MinimumTime, RejectsNarrowCorridorsAndInvalidCars) {
  RacingCar car;
  expect_error_with<std::invalid_argument>({"0.400 m wide", "0.430 m"},
                                           [&] { minimum_time_raceline(circle(5, 0.2), car); });
  // A bend of 0.5 m whose corridor lies beyond the middle of the bend.
  Corridor beyond = circle(0.5, 3);
  for (double& right : beyond.right) right = -1;
  EXPECT_THROW(minimum_time_raceline(beyond, car), std::invalid_argument);
  car.width = -1;
  EXPECT_THROW(minimum_time_raceline(circle(5, 1), car), std::invalid_argument);
  EXPECT_THROW(corridor_from_widths({{0, 0}, {1, 0}}, {1, 1}, {1, 1}, true, 0.1), std::invalid_argument);
  EXPECT_THROW(
      corridor_from_widths({{0, 0}, {1, 0}, {1, 1}, {0, NAN}}, {1, 1, 1, 1}, {1, 1, 1, 1}, true, 0.1),
      std::invalid_argument);
}

}  // namespace
}  // namespace slalom::vehicle::minimum_time_test
