#include "slalom/sim/lidar.hpp"

#include <algorithm>

#include "sim/lidar/scan.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::sim {
namespace {

using std::numbers::pi;

std::size_t padded(int count) {
  return (count + detail::scan_padding - 1) / detail::scan_padding * detail::scan_padding;
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

}  // namespace

LidarOptions LidarOptions::hokuyo_utm_30lx() {
  return {.beams = 1081, .field_of_view = 1.5 * pi, .range_max = 30, .noise = 0.01, .rate = 40};
}

Lidar::Lidar(const LidarOptions& options) : options_(options) {
  detail::scan_kernels();  // which may throw
  validate_options(options, "lidar");
  for (const auto& [name, value] : {std::pair("mount.x", options.mount.x), {"mount.y", options.mount.y}})
    slalom::detail::check("lidar", {name, "m", "", -100, 100}, value);
  slalom::detail::check("lidar", {"mount.yaw", "rad", "", -100, 100}, options.mount.yaw);
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

void Lidar::scan(const Track& track, const maps::Pose& sensor, std::span<float> ranges) const noexcept {
  const maps::Point cell = track.to_cells({sensor.x, sensor.y});
  const maps::OccupancyGrid& grid = track.grid();
  const auto range_max = static_cast<float>(options_.range_max);
  if (!track.contains(cell)) {
    std::fill(ranges.begin(), ranges.end(), track.outside_is_wall() ? 0.0f : range_max);
    return;
  }
  const double yaw = sensor.yaw - grid.origin.yaw;
  detail::scan_kernels().walls(
      {.clearance = track.clearance().data(),
       .stride = track.clearance_stride(),
       .x = static_cast<float>(cell.x + 1),
       .y = static_cast<float>(cell.y + 1),
       .cosine = static_cast<float>(std::cos(yaw)),
       .sine = static_cast<float>(std::sin(yaw)),
       .cosines = cosines_.data(),
       .sines = sines_.data(),
       .beams = options_.beams,
       .cone_cosines = cone_cosines_.data(),
       .cone_sines = cone_sines_.data(),
       .cone_width = static_cast<float>((detail::cone_beams - 1) / 2.0 * options_.angle_increment() + 1e-5),
       .most = static_cast<float>(options_.range_max / grid.resolution),
       .beyond = std::max(1e-3f, static_cast<float>(std::max(grid.width, grid.height)) * 5e-7f),
       .resolution = static_cast<float>(grid.resolution),
       .range_max = range_max,
       .ranges = ranges.data()});
}

void NormalNoise::reset(std::uint64_t seed, std::uint64_t car) noexcept {
  key_ = scramble(scramble(seed + 0x9e3779b97f4a7c15ull) + car);
  count_ = 0;
}

void NormalNoise::add(std::span<float> ranges, int count, double deviation, double most, double dropout) {
  const std::uint64_t now = scramble(key_ + 0x9e3779b97f4a7c15ull * ++count_);
  const detail::NoiseTask task{
      .key0 = static_cast<std::uint32_t>(now),
      .key1 = static_cast<std::uint32_t>(now >> 32),
      .deviation = static_cast<float>(deviation),
      .most = static_cast<float>(most),
      .lost_below = saturate_cast<std::uint32_t>(std::min(dropout * 0x1p32, 0x1p32 - 1)),
      .count = count,
      .ranges = ranges.data()};
  detail::scan_kernels().noise(task);
}

}  // namespace slalom::sim
