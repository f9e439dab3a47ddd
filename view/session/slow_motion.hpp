#pragma once

#include <initializer_list>

#include "slalom/sim/world.hpp"

namespace slalom::view {

/// The rate of a drive that slows down while its cars pass the first obstacle, and then continues in real
/// time.
class SlowMotion {
 public:
  /// The rate of simulated to real time for the next control step. `worlds`: those of all cars; null pointers
  /// are ignored.
  double rate(std::initializer_list<const sim::World*> worlds) noexcept;
  /// Whether the cars have passed the obstacle, so that the rate stays 1.
  bool is_over() const noexcept { return phase_ == Phase::over; }

 private:
  enum class Phase { approaching, passing, over };
  Phase phase_ = Phase::approaching;
  int steps_ = 0;  ///< in the phase `passing`
};

}  // namespace slalom::view
