#include "tracking/readings.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::tracking {
namespace {

constexpr int max_gap_beams = 5;  // beams without a reading within a surface

}  // namespace

double break_distance(double range, double increment, double min_incidence, double deviation) noexcept {
  // Above half of lambda the formula diverges: the beams are too far apart to tell surfaces.
  const double angle = std::min(increment, 0.5 * min_incidence);
  return range * std::sin(angle) / std::sin(min_incidence - angle) + 3 * deviation;
}

Readings::Readings(int max_beams, double max_range)
    : ranges_(max_beams), directions_(ranges_.size()), readings_(ranges_.size()), max_range_(max_range) {}

bool Readings::set(const maps::LaserScanView& scan) noexcept {
  count_ = 0;
  beams_ = 0;
  const std::size_t size = scan.ranges.size();
  if (size < 2 || size > ranges_.size() || !std::isfinite(scan.angle_min) ||
      !std::isfinite(scan.angle_increment) || scan.angle_increment <= 0 ||
      scan.angle_increment * (size - 1) > 2 * std::numbers::pi + 1e-6 || std::isnan(scan.range_min) ||
      std::isnan(scan.range_max))
    return false;
  if (angle_min_ != scan.angle_min || increment_ != scan.angle_increment) known_directions_ = 0;
  angle_min_ = scan.angle_min;
  increment_ = scan.angle_increment;
  beams_ = static_cast<int>(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (i >= known_directions_) {
      const double angle = angle_min_ + i * increment_;
      directions_[i] = {std::cos(angle), std::sin(angle)};
    }
    const double range = scan.ranges[i];
    const bool hit = range > std::max(scan.range_min, 0.0) && range < scan.range_max;
    ranges_[i] = hit ? range : range >= scan.range_max ? std::numeric_limits<double>::infinity() : 0;
    if (hit && range <= max_range_) readings_[count_++] = {{}, range, static_cast<int>(i)};
  }
  known_directions_ = std::max(known_directions_, size);
  return true;
}

void Readings::place(const maps::Pose& sensor) noexcept {
  sensor_ = sensor;
  const double c = std::cos(sensor.yaw), s = std::sin(sensor.yaw);
  for (std::size_t i = 0; i < count_; ++i) {
    Reading& reading = readings_[i];
    const maps::Point towards = direction(reading.beam);
    reading.point = {sensor.x + reading.range * (c * towards.x - s * towards.y),
                     sensor.y + reading.range * (s * towards.x + c * towards.y)};
  }
}

int Readings::beam_at(double bearing) const noexcept {
  double from_first = std::fmod(bearing - angle_min_, 2 * std::numbers::pi);
  if (from_first < -0.5 * increment_) from_first += 2 * std::numbers::pi;
  const double beam = std::round(from_first / increment_);
  return beam >= 0 && beam < beams_ ? saturate_cast<int>(beam) : -1;
}

bool Readings::ends_at(int beam, int step, double min_incidence, double deviation) const noexcept {
  const double here = range(beam);
  for (int apart = 1; apart <= max_gap_beams; ++apart) {
    const int next = beam + apart * step;
    if (next < 0 || next >= beams_) return false;
    const double there = range(next);
    if (there == 0 || std::isinf(there)) continue;
    return there - here > break_distance(here, apart * increment_, min_incidence, deviation);
  }
  return true;
}

}  // namespace slalom::tracking
