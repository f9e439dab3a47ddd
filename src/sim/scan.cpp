#include "sim/scan.hpp"

#include <algorithm>
#include <cmath>

namespace slalom::sim::detail {
namespace {

float walk(const Track& track, float x, float y, float c, float s, float start, float most) {
  const std::int16_t* clearance = track.clearance().data();
  const int stride = track.clearance_stride();
  constexpr float beyond = 1e-3f;  // cells, to be in the next cell for sure
  const float inverse_c = 1 / (std::abs(c) < 1e-9f ? 1e-9f : c),
              inverse_s = 1 / (std::abs(s) < 1e-9f ? 1e-9f : s);
  const int ahead_x = c > 0, ahead_y = s > 0;
  float t = start;
  while (t < most) {
    const float px = x + t * c, py = y + t * s;
    const int column = static_cast<int>(px), row = static_cast<int>(py);
    const int value = clearance[row * stride + column];
    if (value == Track::exit) return most;
    if (value < 0) return std::max(t - beyond, 0.0f);
    const float tx = (static_cast<float>(column + ahead_x) - px) * inverse_c;
    const float ty = (static_cast<float>(row + ahead_y) - py) * inverse_s;
    t += std::max(static_cast<float>(value) / Track::clearance_scale,
                  std::max(std::min(tx, ty), 0.0f) + beyond);
  }
  return most;
}

}  // namespace

void scan(const Track& track, const maps::Pose& sensor, const LidarOptions& options, const Directions& beams,
          std::span<double> ranges) {
  const maps::Point cell = track.to_cells({sensor.x, sensor.y});
  const double resolution = track.grid().resolution;
  const bool inside =
      cell.x >= 0 && cell.y >= 0 && cell.x < track.grid().width && cell.y < track.grid().height;
  if (!inside) {
    std::fill(ranges.begin(), ranges.end(), track.options().outside_is_wall ? 0.0 : options.range_max);
    return;
  }
  const auto x = static_cast<float>(cell.x + 1), y = static_cast<float>(cell.y + 1);
  const auto most = static_cast<float>(options.range_max / resolution);
  const double yaw = sensor.yaw - track.grid().origin.yaw;
  const auto c = static_cast<float>(std::cos(yaw)), s = static_cast<float>(std::sin(yaw));
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float bc = beams.cosines[i], bs = beams.sines[i];
    ranges[i] =
        resolution * static_cast<double>(walk(track, x, y, c * bc - s * bs, s * bc + c * bs, 0, most));
    ranges[i] = std::min(ranges[i], options.range_max);
  }
}

}  // namespace slalom::sim::detail
