#include <algorithm>

#include "sim/lidar/scan.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/sim/lidar.hpp"

namespace slalom::sim {

using std::numbers::pi;

Lidar::Window Lidar::window(const maps::Pose& sensor, const maps::Point& middle,
                            double radius) const noexcept {
  const double dx = middle.x - sensor.x, dy = middle.y - sensor.y, squared = dx * dx + dy * dy;
  const double limit = options_.range_max + radius, increment = options_.angle_increment();
  if (squared > limit * limit) return {0, -1};
  if (squared <= radius * radius || increment == 0) return {0, options_.beams - 1};
  const double half = std::asin(radius / std::sqrt(squared));
  // The bearing from the first beam on, in [0, 2 pi).
  double bearing = std::atan2(dy, dx) - sensor.yaw - options_.angle_min();
  bearing -= std::floor(bearing / (2 * pi)) * (2 * pi);
  Window all{options_.beams, -1};
  const auto include = [&](double from) {
    const double low = std::max(std::ceil((from - half) / increment - 1e-6), 0.0);
    const double high = std::min(std::floor((from + half) / increment + 1e-6), options_.beams - 1.0);
    if (low > high) return;
    all.first = std::min(all.first, saturate_cast<int>(low));
    all.last = std::max(all.last, saturate_cast<int>(high));
  };
  include(bearing);
  // A body that straddles the first beam shows its left part a turn earlier.
  include(bearing - 2 * pi);
  return all;
}

void Lidar::cast(const maps::Pose& sensor, const Box& box, std::span<float> ranges) const noexcept {
  const double radius = std::sqrt(box.length * box.length + box.width * box.width) / 2;
  const maps::Point at = maps::inverse_transform(box.pose, {sensor.x, sensor.y});
  cast_body({at.x, at.y, sensor.yaw - box.pose.yaw}, box.length / 2, box.width / 2, 0,
            window(sensor, {box.pose.x, box.pose.y}, radius), ranges);
}

void Lidar::cast(const maps::Pose& sensor, const Disc& disc, std::span<float> ranges) const noexcept {
  cast_body({sensor.x - disc.middle.x, sensor.y - disc.middle.y, sensor.yaw}, 0, 0, disc.radius,
            window(sensor, disc.middle, disc.radius), ranges);
}

/// Shortens ranges to a body, seen from a sensor in the frame of the body.
void Lidar::cast_body(const maps::Pose& sensor, double half_length, double half_width, double radius,
                      Window beams, std::span<float> ranges) const noexcept {
  if (beams.first > beams.last) return;
  detail::scan_kernels().cast({.x = static_cast<float>(sensor.x),
                               .y = static_cast<float>(sensor.y),
                               .cosine = static_cast<float>(std::cos(sensor.yaw)),
                               .sine = static_cast<float>(std::sin(sensor.yaw)),
                               .cosines = cosines_.data(),
                               .sines = sines_.data(),
                               .half_length = static_cast<float>(half_length),
                               .half_width = static_cast<float>(half_width),
                               .radius = static_cast<float>(radius),
                               .first = beams.first,
                               .last = beams.last,
                               .ranges = ranges.data()});
}

}  // namespace slalom::sim
