#include <algorithm>
#include <cmath>
#include <numbers>

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
  const Window beams = window(sensor, {box.pose.x, box.pose.y}, radius);
  if (beams.first > beams.last) return;
  const maps::Point at = maps::inverse_transform(box.pose, {sensor.x, sensor.y});
  const double yaw = sensor.yaw - box.pose.yaw;
  kernels_->cast({.x = static_cast<float>(at.x),
                  .y = static_cast<float>(at.y),
                  .cosine = static_cast<float>(std::cos(yaw)),
                  .sine = static_cast<float>(std::sin(yaw)),
                  .cosines = cosines_.data(),
                  .sines = sines_.data(),
                  .half_length = static_cast<float>(box.length / 2),
                  .half_width = static_cast<float>(box.width / 2),
                  .radius = 0,
                  .first = beams.first,
                  .last = beams.last,
                  .ranges = ranges.data()});
}

void Lidar::cast(const maps::Pose& sensor, const Disc& disc, std::span<float> ranges) const noexcept {
  const Window beams = window(sensor, disc.middle, disc.radius);
  if (beams.first > beams.last) return;
  kernels_->cast({.x = static_cast<float>(sensor.x - disc.middle.x),
                  .y = static_cast<float>(sensor.y - disc.middle.y),
                  .cosine = static_cast<float>(std::cos(sensor.yaw)),
                  .sine = static_cast<float>(std::sin(sensor.yaw)),
                  .cosines = cosines_.data(),
                  .sines = sines_.data(),
                  .half_length = 0,
                  .half_width = 0,
                  .radius = static_cast<float>(disc.radius),
                  .first = beams.first,
                  .last = beams.last,
                  .ranges = ranges.data()});
}

}  // namespace slalom::sim
