#pragma once

#include "slalom/evaluation/lap.hpp"
#include "slalom/evaluation/lap_figures.hpp"

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
  std::array<double, racing_sectors> sector{};  ///< s, of each sector; NaN where the lap ended before its end
  /// From the start, at distance and time 0, to the end of the lap, where a completed one has its length.
  std::vector<RacingSample> samples{};

  double time() const noexcept { return samples.back().time; }  ///< s; at the end, complete or not
};

/// Where the lap first reached a distance (m), linear between samples. None if it did not get there.
std::optional<RacingSample> at_distance(std::span<const RacingSample> samples, double distance);

/// s, the time at which a lap reached a distance (m) minus that at which `other` did; where a lap ended
/// before, its end counts. Both have samples.
double time_behind(std::span<const RacingSample> lap, std::span<const RacingSample> other, double distance);

/// Times (s) of the equal sectors of a lap of this length (m). NaN for those that the lap did not complete.
std::array<double, racing_sectors> sector_times(std::span<const RacingSample> samples, double length);

/// The acceleration of a car, along and across together, by the time spent with it. 0 without samples.
struct GripUse {
  double p50 = 0;     ///< m/s^2, median
  double p99 = 0;     ///< m/s^2, 99th percentile
  double beyond = 0;  ///< share of the time in which it is above `limit`
};
/// Calls `visit(value, Figure)` for every figure of a use of grip in the order of tables.
template <class Visit>
void visit_figures(const GripUse& grip, Visit&& visit) {
  visit(grip.p50, Figure{"grip_p50", "m/s^2", "median over time of the acceleration"});
  visit(grip.p99, Figure{"grip_p99", "m/s^2", "99th percentile over time of the acceleration"});
  visit(grip.beyond, Figure{"beyond_grip", "", "share of the time outside the friction circle"});
}
/// Returns the grip used in one lap, or in several whose samples follow each other. `limit` in m/s^2.
GripUse grip_use(std::span<const RacingSample> samples, double limit);

/// Laps against the clock.
struct RaceOptions {
  int laps = 1;            ///< standing and flying laps together, completed or not
  std::uint64_t seed = 0;  ///< the standing start that begins lap k (from 0) has lap_seed(seed, k, obstacles)
  bool standing = false;   ///< every lap begins with a standing start
};

/// The reports of a race while it goes on. Both may be empty.
struct RaceCallbacks {
  /// Called in every control step, with the index of the lap from 0; progress and time are those of the lap.
  std::function<void(int lap, const ControlStep& step)> on_step;
  /// Called after every lap.
  std::function<void(const RacingLap& lap)> on_lap;
};

/// Drives laps. The first begins at rest. The car then goes on, so that the others are flying laps, each from
/// where the one before crossed the line. A lap ends early with the first collision, or after the timeout of
/// the setup; the next one begins with a new standing start. So does every lap of an open course. The times
/// at which the car crosses lines are interpolated linearly within a control period. Ends when `cancel`
/// becomes true, without the lap that was being driven. Throws std::invalid_argument for less than one lap
/// and for laps of several rounds, and what LapDrive throws.
std::vector<RacingLap> drive_race(const LapSetup& setup, const RaceOptions& options,
                                  const RaceCallbacks& callbacks = {},
                                  const std::atomic<bool>* cancel = nullptr);

/// The lap that the speed profile of the course asks for: along its line, from where laps of the setup start,
/// at the speeds of its waypoints. `standing`: from rest, with accelerations of at most `grip` (m/s^2, > 0)
/// along and across together until the profile is reached. Throws std::invalid_argument if `grip` is not
/// above 0.
RacingLap profile_lap(const LapSetup& setup, bool standing, double grip);

}  // namespace slalom::evaluation
