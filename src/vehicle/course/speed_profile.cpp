#include "slalom/vehicle/course/speed_profile.hpp"

#include "slalom/core/gravity.hpp"
#include "vehicle/course/speed_passes.hpp"
#include "vehicle/require.hpp"

namespace slalom::vehicle {

SpeedLimits grip_limits(double friction, double top_speed, double acceleration, double braking) {
  const double grip = friction * gravity;
  return {top_speed, grip, std::min(grip, acceleration), std::min(grip, braking)};
}

std::vector<double> feasible_speeds(std::span<const double> given, std::span<const double> curvature,
                                    std::span<const double> step, bool closed, const SpeedLimits& limits) {
  detail::require_plausible(limits);
  detail::require_finite(curvature, step);
  const std::size_t n = given.size();
  if (curvature.size() != n)
    throw std::invalid_argument("feasible_speeds: speed and curvature must have the same size");
  for (std::size_t i = 0; i < n; ++i)
    detail::require(given[i] >= 0, "speed " + std::to_string(i), given[i], "at least 0");
  if (n == 0) return {};
  std::vector<double> speed(n);
  for (std::size_t i = 0; i < n; ++i)
    speed[i] = std::min({given[i], limits.top_speed,
                         std::sqrt(limits.lateral_acceleration / std::max(std::abs(curvature[i]), 1e-9))});
  // The acceleration at the start of a piece holds for all of it.
  const auto reach = [&](double strength) {
    return [&, strength](std::size_t from, std::size_t to, double way) {
      const double v = speed[from];
      const double a = strength * detail::share_left(v, curvature[from], limits.lateral_acceleration);
      speed[to] = std::min(speed[to], std::sqrt(v * v + 2 * a * way));
    };
  };
  detail::for_each_piece(speed, step, closed, reach(limits.acceleration), reach(limits.braking));
  return speed;
}

PathGeometry path_geometry(std::span<const maps::Point> points, std::optional<bool> closed) {
  constexpr double arm = 0.4;  // m, of the chords before and after a point
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
  const auto yaw_of = [&](std::size_t from, std::size_t to) {
    return std::atan2(points[to].y - points[from].y, points[to].x - points[from].x);
  };
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
    const double turned = maps::wrap_angle(yaw_of(i, after) - yaw_of(before, i));
    path.curvature[i] =
        2 * turned / (distance(points[before], points[i]) + distance(points[i], points[after]));
  }
  return path;
}

}  // namespace slalom::vehicle
