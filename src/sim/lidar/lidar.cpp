#include "slalom/sim/lidar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/gym/gym_scan.hpp"
#include "sim/lidar/scan.hpp"
#include "sim/validation.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;

std::size_t padded(int count) {
  return static_cast<std::size_t>((count + detail::scan_padding - 1) / detail::scan_padding *
                                  detail::scan_padding);
}

}  // namespace

LidarOptions LidarOptions::hokuyo_utm_30lx() {
  LidarOptions options;
  options.beams = 1081;
  options.field_of_view = 1.5 * pi;
  options.range_max = 30;
  options.noise = 0.01;
  options.rate = 40;
  return options;
}

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

Lidar::Lidar(const LidarOptions& options) : options_(options), kernels_(&detail::scan_kernels()) {
  options.validate();
  const double first = options.angle_min(), increment = options.angle_increment();
  for (int i = 0; i < options.beams; ++i) angles_.push_back(first + i * increment);
  // Padding repeats the last beam, so that it costs nothing beyond it.
  for (std::size_t i = 0; i < padded(options.beams); ++i) {
    const double angle = angles_[std::min(i, angles_.size() - 1)];
    cosines_.push_back(static_cast<float>(std::cos(angle)));
    sines_.push_back(static_cast<float>(std::sin(angle)));
  }
  const int cones = (options.beams + detail::cone_beams - 1) / detail::cone_beams;
  for (std::size_t i = 0; i < padded(cones); ++i) {
    const double angle = first + (std::min<double>(static_cast<double>(i), cones - 1) * detail::cone_beams +
                                  (detail::cone_beams - 1) / 2.0) *
                                     increment;
    cone_cosines_.push_back(static_cast<float>(std::cos(angle)));
    cone_sines_.push_back(static_cast<float>(std::sin(angle)));
  }
}

maps::Pose Lidar::sensor_pose(const maps::Pose& car) const noexcept {
  const maps::Point at = maps::transform(car, {options_.mount.x, options_.mount.y});
  return {at.x, at.y, car.yaw + options_.mount.yaw};
}

namespace {

/// All of a scan's task but its beams; false if the sensor is not on the map.
bool prepare(const Track& track, const maps::Pose& sensor, const LidarOptions& options,
             detail::ScanTask& task) {
  const maps::Point cell = track.to_cells({sensor.x, sensor.y});
  const maps::OccupancyGrid& grid = track.grid();
  if (!(cell.x >= 0 && cell.y >= 0 && cell.x < grid.width && cell.y < grid.height)) return false;
  const double yaw = sensor.yaw - grid.origin.yaw;
  task.clearance = track.clearance().data();
  task.stride = track.clearance_stride();
  task.x = static_cast<float>(cell.x + 1);
  task.y = static_cast<float>(cell.y + 1);
  task.cosine = static_cast<float>(std::cos(yaw));
  task.sine = static_cast<float>(std::sin(yaw));
  task.cone_width = static_cast<float>((detail::cone_beams - 1) / 2.0 * options.angle_increment() + 1e-5);
  task.most = static_cast<float>(options.range_max / grid.resolution);
  task.beyond = std::max(1e-3f, static_cast<float>(std::max(grid.width, grid.height)) * 5e-7f);
  task.resolution = static_cast<float>(grid.resolution);
  task.range_max = static_cast<float>(options.range_max);
  return true;
}

}  // namespace

void Lidar::scan(const Track& track, const maps::Pose& sensor, std::span<float> ranges) const noexcept {
  detail::ScanTask task{};
  if (!prepare(track, sensor, options_, task)) {
    std::fill(ranges.begin(), ranges.end(),
              track.options().outside_is_wall ? 0.0f : static_cast<float>(options_.range_max));
    return;
  }
  if (options_.gym.directions) return gym_directions_scan(track, sensor, ranges);
  task.cosines = cosines_.data();
  task.sines = sines_.data();
  task.cone_cosines = cone_cosines_.data();
  task.cone_sines = cone_sines_.data();
  task.beams = options_.beams;
  task.ranges = ranges.data();
  kernels_->walls(task);
}

void Lidar::gym_directions_scan(const Track& track, const maps::Pose& sensor,
                                std::span<float> ranges) const noexcept {
  constexpr std::size_t block = detail::scan_padding;
  std::array<float, block> cosines, sines, cone_cosines, cone_sines;
  detail::ScanTask task{};
  prepare(track, sensor, options_, task);
  const double turn = track.grid().origin.yaw;
  task.cosine = static_cast<float>(std::cos(turn));
  task.sine = static_cast<float>(-std::sin(turn));
  // A table's entries are off by up to its step.
  task.cone_width += 0.0035f;
  detail::GymDirections directions(sensor.yaw, options_);
  for (std::size_t first = 0; first < angles_.size(); first += block) {
    const std::size_t here = std::min(block, angles_.size() - first);
    for (std::size_t i = 0; i < block; ++i) {
      const auto direction = i < here ? directions.next() : maps::Point{cosines[here - 1], sines[here - 1]};
      cosines[i] = static_cast<float>(direction.x);
      sines[i] = static_cast<float>(direction.y);
    }
    const double middle = (detail::cone_beams - 1) / 2.0 * options_.angle_increment();
    for (std::size_t i = 0; i < block; ++i) {
      const std::size_t beam = std::min(first + i * detail::cone_beams, angles_.size() - 1);
      const double angle = sensor.yaw + angles_[beam] + middle;
      cone_cosines[i] = static_cast<float>(std::cos(angle));
      cone_sines[i] = static_cast<float>(std::sin(angle));
    }
    task.cosines = cosines.data();
    task.sines = sines.data();
    task.cone_cosines = cone_cosines.data();
    task.cone_sines = cone_sines.data();
    task.beams = static_cast<int>(here);
    task.ranges = ranges.data() + first;
    kernels_->walls(task);
  }
}

void Lidar::gym_scan(const Track& track, const maps::Pose& sensor, std::span<double> ranges) const noexcept {
  detail::gym_scan(track, sensor, options_, angles_, ranges);
}

}  // namespace slalom::sim
