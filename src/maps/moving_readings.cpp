#include "slalom/maps/moving_readings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slalom::maps {

void drop_readings_of(const PredictedObstacle& obstacle, double margin, const Pose& sensor,
                      const LaserScanView& scan, std::span<float> ranges) noexcept {
  // Beams further apart than half a turn are no scan; a loop over their turns would hardly end.
  const bool turns_left = scan.angle_increment > 0 && scan.angle_increment < std::numbers::pi;
  if (obstacle.poses.empty() || !turns_left) return;
  const Pose& box = obstacle.poses.front().pose;
  const double half_length = 0.5 * obstacle.length + margin, half_width = 0.5 * obstacle.width + margin;
  const double distance = std::hypot(box.x - sensor.x, box.y - sensor.y),
               radius = std::hypot(half_length, half_width);
  const double bearing = std::atan2(box.y - sensor.y, box.x - sensor.x) - sensor.yaw;
  const double reach = distance > radius ? std::asin(radius / distance) : std::numbers::pi;
  const double first = (wrap_angle(bearing - scan.angle_min - reach)) / scan.angle_increment;
  if (!std::isfinite(first)) return;
  const double turn = 2 * std::numbers::pi / scan.angle_increment;
  // Beams may cover more than a turn, and angles are known up to whole turns.
  for (double begin = first - turn; begin < static_cast<double>(ranges.size()); begin += turn) {
    const double end =
        std::min(begin + 2 * reach / scan.angle_increment + 1, static_cast<double>(ranges.size()));
    for (double beam = std::max(std::floor(begin), 0.0); beam < end; ++beam) {
      float& range = ranges[static_cast<std::size_t>(beam)];
      const double angle = sensor.yaw + scan.angle_min + beam * scan.angle_increment;
      const Point point = inverse_transform(box, {sensor.x + static_cast<double>(range) * std::cos(angle),
                                                  sensor.y + static_cast<double>(range) * std::sin(angle)});
      if (std::abs(point.x) <= half_length && std::abs(point.y) <= half_width)
        range = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

}  // namespace slalom::maps
