#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "slalom/evaluation/lap.hpp"
#include "slalom/evaluation/racing_lap.hpp"

namespace slalom::evaluation {

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
