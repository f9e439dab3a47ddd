#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace slalom::evaluation {

/// Parts of a lap of equal length that are timed.
inline constexpr int racing_sectors = 3;

/// A car on its way round a course. Its accelerations are means since the sample before.
struct RacingSample {
  double distance = 0;      ///< m along the course line from the start of the lap
  double time = 0;          ///< s since the start of the lap
  double speed = 0;         ///< m/s
  double longitudinal = 0;  ///< m/s^2, along the direction of travel
  double lateral = 0;       ///< m/s^2, to its left
};

/// The end of a lap against the clock.
enum class RacingEnd {
  completed,  ///< the car crossed the line
  collision,  ///< it hit a wall or another body
  timeout,    ///< it did not come to the line in time
};
/// The name of an end in results.
std::string_view name(RacingEnd end) noexcept;

/// A lap against the clock.
struct RacingLap {
  bool standing = true;                  ///< the car starts at rest; else the lap is a flying one
  std::uint64_t seed = 0;                ///< seed of the standing start that this lap begins with or follows
  RacingEnd end = RacingEnd::completed;  ///< how it ended
  std::array<double, racing_sectors> sector;  ///< s, of each sector; NaN where the lap ended before its end
  /// From the start, at distance and time 0, to the end of the lap, where a completed one has its whole
  /// length.
  std::vector<RacingSample> samples;

  double time() const noexcept { return samples.back().time; }  ///< s; at the end, complete or not
};

/// Where the lap first reached a distance (m), linear between samples. None if it did not get there.
std::optional<RacingSample> at_distance(std::span<const RacingSample> samples, double distance);

/// s, the time at which a lap reached a distance (m) minus that at which `other` did; where a lap ended
/// before, its end counts. Both have samples.
double time_behind(std::span<const RacingSample> lap, std::span<const RacingSample> other, double distance);

/// Times (s) of the equal sectors of a lap of this length (m). NaN for those that the lap did not complete.
std::array<double, racing_sectors> sector_times(std::span<const RacingSample> samples, double length);

/// The acceleration of a car, longitudinal and lateral together, by the time spent with it. 0 without
/// samples.
struct GripUse {
  double p50 = 0;     ///< m/s^2, median
  double p99 = 0;     ///< m/s^2, 99th percentile
  double beyond = 0;  ///< share of the time in which it is above `limit`
};
/// Returns the grip used in one lap, or in several whose samples follow each other. `limit` in m/s^2.
GripUse grip_use(std::span<const RacingSample> samples, double limit);

}  // namespace slalom::evaluation
