#include "slalom/vehicle/course/speed_profile.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace slalom::vehicle {
namespace {

constexpr double gravity = 9.81;  // m/s^2

void require_positive(const char* key, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw std::invalid_argument(std::string(key) + ": " + std::to_string(value) +
                                " must be finite and above 0");
}

void require_positive(const SpeedLimits& limits) {
  require_positive("top_speed", limits.top_speed);
  require_positive("lateral_acceleration", limits.lateral_acceleration);
  require_positive("acceleration", limits.acceleration);
  require_positive("braking", limits.braking);
}

/// The share of the tyres' force that is left for accelerating when turning at `speed`, 0..1.
double share_left(double speed, double curvature, double lateral_acceleration) {
  const double used = speed * speed * curvature / lateral_acceleration;
  return std::sqrt(std::max(0.0, 1 - used * used));
}

double yaw_of(const maps::Point& from, const maps::Point& to) {
  return std::atan2(to.y - from.y, to.x - from.x);
}

double distance(const maps::Point& a, const maps::Point& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

}  // namespace

SpeedLimits grip_limits(double friction, double top_speed, double acceleration, double braking) {
  const double grip = friction * gravity;
  return {top_speed, grip, std::min(grip, acceleration), std::min(grip, braking)};
}

std::vector<double> speed_profile(const std::vector<double>& curvature, double step,
                                  const SpeedLimits& limits) {
  require_positive("step", step);
  const std::size_t n = curvature.size();
  return feasible_speeds(std::vector<double>(n, limits.top_speed), curvature, std::vector<double>(n, step),
                         true, limits);
}

std::vector<double> feasible_speeds(std::span<const double> given, std::span<const double> curvature,
                                    std::span<const double> step, bool closed, const SpeedLimits& limits) {
  require_positive(limits);
  const std::size_t n = given.size();
  if (curvature.size() != n || step.size() != n)
    throw std::invalid_argument("feasible_speeds: speed, curvature and step must have the same size");
  if (n == 0) return {};
  std::vector<double> speed(n);
  for (std::size_t i = 0; i < n; ++i)
    speed[i] = std::min({given[i], limits.top_speed,
                         std::sqrt(limits.lateral_acceleration / std::max(std::abs(curvature[i]), 1e-9))});
  const auto pass = [&](std::size_t from, std::size_t to, double way, double strength) {
    const double a = strength * share_left(speed[from], curvature[from], limits.lateral_acceleration);
    speed[to] = std::min(speed[to], std::sqrt(speed[from] * speed[from] + 2 * a * way));
  };
  // The slowest point of a closed path keeps its speed, so one pass from it is exact.
  const auto slowest =
      closed ? static_cast<std::size_t>(std::min_element(speed.begin(), speed.end()) - speed.begin()) : 0;
  const std::size_t steps = closed ? n : n - 1;
  for (std::size_t k = 0; k < steps; ++k) {
    const std::size_t from = (slowest + k) % n;
    pass(from, (from + 1) % n, step[from], limits.acceleration);
  }
  for (std::size_t k = steps; k > 0; --k) {
    const std::size_t to = (slowest + k - 1) % n;
    pass((to + 1) % n, to, step[to], limits.braking);
  }
  return speed;
}

PathGeometry path_geometry(std::span<const maps::Point> points, std::optional<bool> closed, double arm) {
  PathGeometry path;
  const std::size_t n = points.size();
  path.step.assign(n, 0);
  path.curvature.assign(n, 0);
  if (n < 2) return path;
  double longest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    path.step[i] = distance(points[i], points[(i + 1) % n]);
    if (i + 1 < n) longest = std::max(longest, path.step[i]);
  }
  path.closed = closed.value_or(path.step[n - 1] <= 3 * longest);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t before = i, after = i;
    double way_before = 0, way_after = 0;
    while (way_before < arm && (path.closed || before > 0) && (before + n - 1) % n != after) {
      before = (before + n - 1) % n;
      way_before += path.step[before];
    }
    while (way_after < arm && (path.closed || after + 1 < n) && (after + 1) % n != before) {
      way_after += path.step[after];
      after = (after + 1) % n;
    }
    if (before == i || after == i) continue;  // an end of an open path
    const double turned =
        maps::wrap_angle(yaw_of(points[i], points[after]) - yaw_of(points[before], points[i]));
    path.curvature[i] =
        2 * turned / (distance(points[before], points[i]) + distance(points[i], points[after]));
  }
  return path;
}

}  // namespace slalom::vehicle
