#include "slalom/sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/gym_scan.hpp"
#include "sim/require.hpp"
#include "sim/scan.hpp"

namespace slalom::sim {
namespace {

constexpr double pi = 3.141592653589793;

}  // namespace

void LidarOptions::validate() const {
  detail::require_range("beams", beams, 1, 100000);
  detail::require_range("field_of_view", field_of_view, 0, 2 * pi);
  detail::require_range("range_max", range_max, 1e-3, 1e4);
  detail::require_range("noise", noise, 0, 100);
  detail::require_range("rate", rate, 0, 1e6);
  detail::require_finite("mount x", mount.x);
  detail::require_finite("mount y", mount.y);
  detail::require_finite("mount yaw", mount.yaw);
  detail::require_range("dropout", dropout, 0, 1);
}

Lidar::Lidar(const LidarOptions& options) : options_(options) {
  options.validate();
  const auto padded =
      static_cast<std::size_t>((options.beams + detail::cone_beams - 1) / detail::cone_beams) *
      detail::cone_beams;
  for (int i = 0; i < options.beams; ++i)
    angles_.push_back(options.angle_min() + i * options.angle_increment());
  for (std::size_t i = 0; i < padded; ++i) {
    // Padding repeats the last beam, which costs nothing beyond it.
    const double angle = angles_[std::min(i, angles_.size() - 1)];
    cosines_.push_back(static_cast<float>(std::cos(angle)));
    sines_.push_back(static_cast<float>(std::sin(angle)));
  }
}

maps::Pose Lidar::sensor_pose(const maps::Pose& car) const noexcept {
  const maps::Point at = maps::transform(car, {options_.mount.x, options_.mount.y});
  return {at.x, at.y, car.yaw + options_.mount.yaw};
}

void Lidar::scan(const Track& track, const maps::Pose& sensor, std::span<double> ranges) const noexcept {
  if (options_.gym_ranges) return detail::gym_scan(track, sensor, options_, angles_, ranges);
  detail::scan(track, sensor, options_, {cosines_, sines_}, ranges);
}

Lidar::Window Lidar::window(double bearing, double half_angle) const noexcept {
  const double increment = options_.angle_increment(), first = options_.angle_min();
  if (options_.beams == 1 || increment == 0) return {0, options_.beams - 1};
  // A bearing and the same less a turn: the field of view may span more than half of one.
  Window all{options_.beams, -1};
  for (const double turn : {-2 * pi, 0.0, 2 * pi}) {
    const double low = std::ceil((bearing + turn - half_angle - first) / increment - 1e-6);
    const double high = std::floor((bearing + turn + half_angle - first) / increment + 1e-6);
    if (low > options_.beams - 1 || high < 0 || low > high) continue;
    all.first = std::min(all.first, static_cast<int>(std::max(low, 0.0)));
    all.last = std::max(all.last, static_cast<int>(std::min(high, options_.beams - 1.0)));
  }
  return all;
}

Lidar::Window Lidar::gym_window(const maps::Pose& sensor, const Box& box) const noexcept {
  Window all{options_.beams - 1, 0};
  for (const maps::Point& corner : corners(box)) {
    const double heading = std::atan2(std::sin(sensor.yaw), std::cos(sensor.yaw));
    const double dx = corner.x - sensor.x, dy = corner.y - sensor.y, distance = std::sqrt(dx * dx + dy * dy);
    double angle = heading - std::atan2(dy / distance, dx / distance);
    if (angle > pi) angle -= 2 * pi;
    if (angle < -pi) angle += 2 * pi;
    const auto nearer = [&](double a, double b) { return std::abs(a + angle) < std::abs(b + angle); };
    const auto nearest = std::min_element(angles_.begin(), angles_.end(), nearer);
    const int beam = static_cast<int>(nearest - angles_.begin());
    all.first = std::min(all.first, beam);
    all.last = std::max(all.last, beam);
  }
  return all;
}

namespace {

/// Distance, bearing and half the angle under which a disc of `radius` is seen.
struct Sight {
  double distance, bearing, half_angle;
};

Sight sight(const maps::Pose& sensor, double x, double y, double radius) {
  const double dx = x - sensor.x, dy = y - sensor.y, distance = std::hypot(dx, dy);
  const double half = distance > radius ? std::asin(radius / distance) : pi;
  return {distance, std::remainder(std::atan2(dy, dx) - sensor.yaw, 2 * pi), half};
}

}  // namespace

void Lidar::cast(const maps::Pose& sensor, const Box& box, std::span<double> ranges) const noexcept {
  const double radius = std::hypot(box.length, box.width) / 2;
  const Sight seen = sight(sensor, box.pose.x, box.pose.y, radius);
  if (!options_.gym_window && seen.distance - radius > options_.range_max) return;
  const Window beams = options_.gym_window ? gym_window(sensor, box) : window(seen.bearing, seen.half_angle);
  for (int i = beams.first; i <= beams.last; ++i) {
    const auto beam = static_cast<std::size_t>(i);
    const double angle = sensor.yaw + angles_[beam];
    const double distance = ray_distance({sensor.x, sensor.y}, std::cos(angle), std::sin(angle), box);
    if (distance < ranges[beam]) ranges[beam] = distance;
  }
}

void Lidar::cast(const maps::Pose& sensor, const Disc& disc, std::span<double> ranges) const noexcept {
  const Sight seen = sight(sensor, disc.middle.x, disc.middle.y, disc.radius);
  if (seen.distance - disc.radius > options_.range_max) return;
  const Window beams = window(seen.bearing, seen.half_angle);
  for (int i = beams.first; i <= beams.last; ++i) {
    const auto beam = static_cast<std::size_t>(i);
    const double angle = sensor.yaw + angles_[beam];
    const double distance = ray_distance({sensor.x, sensor.y}, std::cos(angle), std::sin(angle), disc);
    if (distance < ranges[beam]) ranges[beam] = distance;
  }
}

}  // namespace slalom::sim
