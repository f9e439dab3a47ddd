#include "slalom/vehicle/course/speed_profile.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace slalom::vehicle {
namespace {

void require_positive(const char* key, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw std::invalid_argument(std::string(key) + ": " + std::to_string(value) +
                                " must be finite and above 0");
}

/// The share of the tyres' force that is left for accelerating when turning at `speed`, 0..1.
double share_left(double speed, double curvature, double lateral_acceleration) {
  const double used = speed * speed * curvature / lateral_acceleration;
  return std::sqrt(std::max(0.0, 1 - used * used));
}

}  // namespace

std::vector<double> speed_profile(const std::vector<double>& curvature, double step,
                                  const SpeedLimits& limits) {
  require_positive("top_speed", limits.top_speed);
  require_positive("lateral_acceleration", limits.lateral_acceleration);
  require_positive("acceleration", limits.acceleration);
  require_positive("braking", limits.braking);
  require_positive("step", step);
  const std::size_t n = curvature.size();
  if (n == 0) return {};
  std::vector<double> speed(n);
  for (std::size_t i = 0; i < n; ++i)
    speed[i] = std::min(limits.top_speed,
                        std::sqrt(limits.lateral_acceleration / std::max(std::abs(curvature[i]), 1e-9)));
  const auto slowest = static_cast<std::size_t>(std::min_element(speed.begin(), speed.end()) - speed.begin());
  const auto pass = [&](std::size_t from, std::size_t to, double strength) {
    const double a = strength * share_left(speed[from], curvature[from], limits.lateral_acceleration);
    speed[to] = std::min(speed[to], std::sqrt(speed[from] * speed[from] + 2 * a * step));
  };
  // The slowest point of a closed path keeps its speed, so one pass from it is exact.
  for (std::size_t k = 0; k < n; ++k) pass((slowest + k) % n, (slowest + k + 1) % n, limits.acceleration);
  for (std::size_t k = n; k > 0; --k) pass((slowest + k) % n, (slowest + k - 1) % n, limits.braking);
  return speed;
}

}  // namespace slalom::vehicle
