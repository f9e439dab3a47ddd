#include <algorithm>
#include <cmath>
#include <numbers>

#include "localiser_sensor.hpp"

namespace slalom::vehicle::detail {
namespace {

/// A change of the expected range by more than this many times the distance across the beam is the edge of an
/// object and not a wall at a small angle to the beam; ranges (m) below the second one count as it.
constexpr double steepest_wall = 8, shortest_lever = 0.05;

}  // namespace

bool choose_beams(const maps::LaserScanView& scan, const LocaliserOptions& options,
                  ScanBeams& beams) noexcept {
  beams.hits = beams.count = 0;
  const std::size_t readings = scan.ranges.size();
  if (readings == 0 || !std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment) ||
      !std::isfinite(scan.range_min) || std::isnan(scan.range_max)) {
    return false;
  }
  const std::size_t parts = std::min(readings, static_cast<std::size_t>(options.beams));
  const double bins_per_turn = table_angles / (2 * std::numbers::pi);
  const auto add = [&](std::size_t at, double range, std::size_t reading) {
    const double bearing =
        options.laser_yaw + scan.angle_min + static_cast<double>(reading) * scan.angle_increment;
    beams.end_x[at] = static_cast<float>(options.laser_x + range * std::cos(bearing));
    beams.end_y[at] = static_cast<float>(options.laser_y + range * std::sin(bearing));
    beams.range[at] = static_cast<float>(range);
    const double bin = maps::wrap_angle(bearing) * bins_per_turn;
    const double across = bins_per_turn / std::max(range, shortest_lever);
    beams.forward_x[at] = static_cast<float>(std::cos(bearing));
    beams.forward_y[at] = static_cast<float>(std::sin(bearing));
    beams.sideways_x[at] = static_cast<float>(-across * std::sin(bearing));
    beams.sideways_y[at] = static_cast<float>(across * std::cos(bearing));
    beams.steepest[at] = static_cast<float>(steepest_wall / across);
    beams.bin[at] = std::min(static_cast<float>(bin < 0 ? bin + table_angles : bin),
                             static_cast<float>(table_angles - 1e-3));
  };
  const double least = std::max(scan.range_min, 0.0), most = std::min(options.range_cap, scan.range_max);
  std::size_t lost = parts;  // those without return gather at the back
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = part * readings / parts, end = (part + 1) * readings / parts;
    std::size_t missed = end;
    for (std::size_t i = begin + (end - begin) / 2, looked = 0; looked < end - begin; ++looked) {
      const double range = static_cast<double>(scan.ranges[i]);
      if (range > least && range < most) {
        add(static_cast<std::size_t>(beams.hits++), range, i);
        missed = end;
        break;
      }
      if (range >= most && missed == end) missed = i;
      if (++i == end) i = begin;
    }
    if (missed != end) add(--lost, options.range_cap, missed);
  }
  beams.count = beams.hits;
  for (; lost < parts; ++lost, ++beams.count) {
    const std::size_t to = static_cast<std::size_t>(beams.count);
    beams.end_x[to] = beams.end_x[lost];
    beams.end_y[to] = beams.end_y[lost];
    beams.range[to] = beams.range[lost];
    beams.bin[to] = beams.bin[lost];
  }
  return beams.hits >= options.min_beams;
}

}  // namespace slalom::vehicle::detail
