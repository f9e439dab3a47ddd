#pragma once

#include <algorithm>
#include <chrono>

namespace slalom::view {

constexpr auto min_frame_gap = std::chrono::milliseconds(12);  ///< no screen shows more
constexpr auto max_state_gap = std::chrono::seconds(1);        ///< between two messages of the state

/// Tells when the next step of a drive is due, and measures how fast the drive goes. `rate`: simulated to
/// real time, 0 for the maximum speed; `period`: s of a step.
struct Pace {
  using Clock = std::chrono::steady_clock;
  Clock::time_point due = Clock::now();
  Clock::time_point since = due;  ///< from when the pace is measured
  int steps = 0;                  ///< since then

  Clock::duration until_due(double rate) const {
    return rate > 0 ? due - Clock::now() : Clock::duration::zero();
  }
  /// Notes that a step begins.
  void step(double period, double rate) {
    ++steps;
    if (rate <= 0) return;
    constexpr int max_late_steps = 4;  // that a late clock may owe
    const auto step =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period / rate));
    due = std::max(due + step, Clock::now() - max_late_steps * step);
  }
  /// Returns the simulated time per time; `before`, the last one, if too little time has passed.
  double measure(double before, double period, bool paused) {
    constexpr double least = 0.5;  // s
    const double passed = std::chrono::duration<double>(Clock::now() - since).count();
    if (passed < least && !paused) return before;
    const double pace = paused ? 0 : steps * period / passed;
    since = Clock::now();
    steps = 0;
    return pace;
  }
  /// Whether a person waits for the next step.
  static bool is_slow(double period, double rate) { return rate > 0 && period > 0.05 * rate; }
};

}  // namespace slalom::view
