#pragma once

#include <cmath>

namespace slalom::vehicle::detail {

/// Backing out of a dead end. A car that stands before something it cannot steer round, since every plan from
/// there collides, gains the room to do so by going back straight a little, the way it came.
class BackUp {
 public:
  static constexpr double speed = 0.5;  ///< m/s

  void reset() noexcept { *this = {}; }

  /// A control period passes: is no plan `free`, and at what speed (m/s) does the car move? Returns whether
  /// it is to go back now.
  bool update(bool free, double speed_now, double period) noexcept {
    if (back_for_ > 0) {
      back_for_ += period;
      if (back_for_ > longest || (free && back_for_ > shortest)) back_for_ = standing_for_ = 0;
    } else {
      standing_for_ = free || std::abs(speed_now) > standing ? 0 : standing_for_ + period;
      if (standing_for_ >= patience) back_for_ = period;
    }
    return back_for_ > 0;
  }

 private:
  static constexpr double standing = 0.1;  ///< m/s, slower is standing
  static constexpr double patience = 0.3;  ///< s of standing before it goes back
  static constexpr double shortest = 0.6;  ///< s of going back at least
  static constexpr double longest = 2.0;   ///< s of going back at most; then it waits and looks again

  double standing_for_ = 0;  ///< s
  double back_for_ = 0;      ///< s; 0 while it does not go back
};

}  // namespace slalom::vehicle::detail
