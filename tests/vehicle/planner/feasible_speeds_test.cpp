// Where plans look up the speeds that a car can drive along a path.
#include "vehicle/planner/feasible_speeds.hpp"

#include <gtest/gtest.h>

#include "vehicle/planner/map_options.hpp"

namespace slalom::vehicle::detail::feasible_speeds_test {
namespace {

constexpr double grip = 8, radius = 1, straight = 10;

/// Two straights of this length (m) joined by half circles, with a point each `spacing` m and a top speed.
std::vector<maps::ReferencePoint> oval(double top_speed, double length = straight, double bend = radius,
                                       double spacing = 0.1) {
  std::vector<maps::ReferencePoint> path;
  for (const double side : {1.0, -1.0}) {
    const double yaw = side > 0 ? 0 : M_PI;
    for (int i = 0; i < std::lround(length / spacing); ++i)
      path.push_back({side * (spacing * i - 0.5 * length), -side * bend, yaw, top_speed});
    const int pieces = static_cast<int>(M_PI * bend / spacing);
    for (int i = 0; i < pieces; ++i) {
      const double turned = M_PI * i / pieces;
      path.push_back({side * (0.5 * length + bend * std::sin(turned)), -side * bend * std::cos(turned),
                      turned + yaw, top_speed});
    }
  }
  return path;
}

/// The speed at a distance along the path, between its points.
double at(const FeasibleSpeeds& speeds, double arc) {
  const int count = static_cast<int>(speeds.speeds().size());
  arc = std::fmod(arc, speeds.length());
  int i = 0;
  while (i + 1 < count && speeds.arc(i + 1) <= arc) ++i;
  const double end = i + 1 < count ? speeds.arc(i + 1) : speeds.length();
  const double share = (arc - speeds.arc(i)) / (end - speeds.arc(i));
  const auto value = [&](int k) { return speeds.speeds()[k % count]; };
  return value(i) + share * (value(i + 1) - value(i));
}

TEST(FeasibleSpeeds, KeepToGripBrakesAndMotor) {
  const auto path = oval(12, 30, 3, 0.2);
  FeasibleSpeeds speeds(path);
  EXPECT_EQ(speeds.speeds()[0], 12);
  speeds.update({.grip = 8, .acceleration = 9, .braking = 6, .delay = 0, .switch_speed = 7});
  const auto v = speeds.speeds();
  EXPECT_NEAR(v[170], std::sqrt(8.0 * 3), 0.15) << "in the middle of the curve";
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t next = (i + 1) % v.size();
    const double way = std::hypot(path[next].x - path[i].x, path[next].y - path[i].y);
    const double change = (v[next] * v[next] - v[i] * v[i]) / (2 * way);
    EXPECT_GT(change, -6.001) << "point " << i;
    EXPECT_LT(change, 8.001) << "point " << i;
    if (v[i] > 7) {
      EXPECT_LT(change, 9 * 7 / v[i] + 1e-6) << "point " << i;
    }
  }
  const std::vector<double> fast(v.begin(), v.end());
  speeds.update({.grip = 8, .acceleration = 9, .braking = 9, .braking_share = 0.6, .delay = 0});
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t next = (i + 1) % v.size();
    const double way = std::hypot(path[next].x - path[i].x, path[next].y - path[i].y);
    EXPECT_GT((v[next] * v[next] - v[i] * v[i]) / (2 * way), -0.6 * 8.001) << "point " << i;
  }
  speeds.update({.grip = 4, .acceleration = 9, .braking = 6, .delay = 0.05, .switch_speed = 7});
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_LE(speeds.speeds()[i], fast[i]);
}

TEST(FeasibleSpeeds, WithALeadACarThatLooksThemUpAtTheBeginOfAStepHasThemAtItsEnd) {
  constexpr double step = 0.05;  // s
  const DrivingLimits limits{.grip = grip, .acceleration = grip, .braking = grip, .switch_speed = 100};
  FeasibleSpeeds profile(oval(7)), late(oval(7)), led(oval(7));
  profile.update(limits);
  DrivingLimits changed = limits;
  changed.delay = step;
  late.update(changed);
  changed = limits;
  changed.lead = step;
  led.update(changed);
  const auto worst_error = [&](const FeasibleSpeeds& looked_up) {
    double worst = 0, arc = straight + 0.5 * M_PI * radius, speed = at(profile, arc);
    for (int k = 0; k < 200; ++k) {
      const double next = at(looked_up, arc);
      arc += 0.5 * step * (speed + next);
      speed = next;
      worst = std::max(worst, std::abs(speed - at(profile, arc)));
    }
    return worst;
  };
  EXPECT_LT(worst_error(led), 0.15);
  EXPECT_GT(worst_error(late), 0.3) << "a car that leaves the curve is a step late";
}

TEST(FeasibleSpeeds, EachPartOfThePathHasItsShareOfTheGrip) {
  // The first half of the path is a straight and a half circle, the second half the others.
  const DrivingLimits limits{.grip = grip, .acceleration = grip, .braking = grip, .switch_speed = 100};
  const std::vector<double> shares{1, 0.5};
  FeasibleSpeeds all(oval(7)), parts(oval(7), shares);
  all.update(limits);
  parts.update(limits);
  const double middle = straight + 0.5 * M_PI * radius, half = 0.5 * all.length();
  EXPECT_NEAR(at(parts, middle), at(all, middle), 1e-9);
  EXPECT_NEAR(at(parts, middle + half), std::sqrt(0.5) * at(all, middle), 0.02);
}

TEST(FeasibleSpeeds, AnOpenPathKeepsItsLastSpeed) {
  auto path = oval(7);
  path.resize(90);  // the first straight, not joined
  for (std::size_t i = 0; i < 30; ++i) path[i].speed = 3;
  FeasibleSpeeds speeds(path);
  speeds.update({.grip = grip, .acceleration = grip, .braking = grip, .lead = 0.2, .switch_speed = 100});
  EXPECT_EQ(speeds.length(), 0);
  EXPECT_NEAR(speeds.speeds().front(), 3, 1e-12);
  EXPECT_NEAR(speeds.speeds().back(), 7, 1e-12) << "the path does not go on at its start";
  EXPECT_NEAR(speeds.speeds()[20], 3, 1e-12) << "0.6 m ahead";
  EXPECT_GT(speeds.speeds()[26], 3.1) << "0.6 m ahead, on the fast part";
}

TEST(LimitedPath, AnOpenPathEndsWithAStop) {
  std::vector<maps::ReferencePoint> line, circle;
  for (int i = 0; i <= 100; ++i) {
    line.push_back({0.2 * i, 0, 0, 5});
    const double angle = 2 * 3.14159265358979 * i / 101;
    circle.push_back({5 * std::cos(angle), 5 * std::sin(angle), 0, 5});
  }
  VehicleTraits traits{.max_deceleration = 8};
  PlannerOptions options;
  const auto open = limited_path(line, options, traits);
  EXPECT_EQ(open.back().speed, 0);
  EXPECT_NEAR(open[95].speed, std::sqrt(2 * 0.5 * 8 * 1.0), 1e-9) << "1 m before the end";
  EXPECT_EQ(open.front().speed, 5);
  for (const maps::ReferencePoint& point : limited_path(circle, options, traits)) EXPECT_EQ(point.speed, 5);
  options.published.maps = true;
  EXPECT_EQ(limited_path(line, options, traits).back().speed, 5) << "the published program does not stop";
}

}  // namespace
}  // namespace slalom::vehicle::detail::feasible_speeds_test
