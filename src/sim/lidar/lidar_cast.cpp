#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/lidar/scan.hpp"
#include "slalom/sim/lidar.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;

}  // namespace

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
    all.first = std::min(all.first, static_cast<int>(low));
    all.last = std::max(all.last, static_cast<int>(high));
  };
  include(bearing);
  // A body that straddles the first beam shows its left part a turn earlier.
  include(bearing - 2 * pi);
  return all;
}

Lidar::Window Lidar::gym_window(const maps::Pose& sensor, const Box& box) const noexcept {
  Window all{options_.beams - 1, 0};
  const double heading = std::atan2(std::sin(sensor.yaw), std::cos(sensor.yaw));
  for (const maps::Point& corner : corners(box)) {
    const double dx = corner.x - sensor.x, dy = corner.y - sensor.y, distance = std::sqrt(dx * dx + dy * dy);
    double angle = heading - std::atan2(dy / distance, dx / distance);
    if (angle > pi) angle -= 2 * pi;
    if (angle < -pi) angle += 2 * pi;
    const auto nearer = [&](double a, double b) { return std::abs(a + angle) < std::abs(b + angle); };
    // The beams stand evenly, so the nearest is one of the few about where it should be.
    const double increment = options_.angle_increment(), last = static_cast<double>(options_.beams - 1);
    const double about = increment > 0 ? (-angle - angles_.front()) / increment : 0;
    const auto begin = angles_.begin() + static_cast<std::ptrdiff_t>(std::clamp(about - 2, 0.0, last)),
               end = angles_.begin() + static_cast<std::ptrdiff_t>(std::clamp(about + 3, 0.0, last)) + 1;
    const auto nearest = std::min_element(begin, end, nearer);
    const int beam = static_cast<int>(nearest - angles_.begin());
    all.first = std::min(all.first, beam);
    all.last = std::max(all.last, beam);
  }
  return all;
}

void Lidar::cast(const maps::Pose& sensor, const Box& box, std::span<float> ranges) const noexcept {
  const double radius = std::sqrt(box.length * box.length + box.width * box.width) / 2;
  const Window beams =
      options_.gym.window ? gym_window(sensor, box) : window(sensor, {box.pose.x, box.pose.y}, radius);
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

void Lidar::gym_cast(const maps::Pose& sensor, const Box& box, std::span<double> ranges) const noexcept {
  const double radius = std::sqrt(box.length * box.length + box.width * box.width) / 2;
  const Window beams =
      options_.gym.window ? gym_window(sensor, box) : window(sensor, {box.pose.x, box.pose.y}, radius);
  for (int i = beams.first; i <= beams.last; ++i) {
    const auto beam = static_cast<std::size_t>(i);
    const double angle = sensor.yaw + angles_[beam];
    ranges[beam] =
        std::min(ranges[beam], ray_distance({sensor.x, sensor.y}, std::cos(angle), std::sin(angle), box));
  }
}

void Lidar::gym_cast(const maps::Pose& sensor, const Disc& disc, std::span<double> ranges) const noexcept {
  const Window beams = window(sensor, disc.middle, disc.radius);
  for (int i = beams.first; i <= beams.last; ++i) {
    const auto beam = static_cast<std::size_t>(i);
    const double angle = sensor.yaw + angles_[beam];
    ranges[beam] =
        std::min(ranges[beam], ray_distance({sensor.x, sensor.y}, std::cos(angle), std::sin(angle), disc));
  }
}

}  // namespace slalom::sim
