#pragma once

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {

/// Backing out of a dead end. A car that stands before something it cannot steer round, since every plan from
/// there collides, gains the room to do so by going back straight a little, the way it came. If it soon
/// stands again it goes back further.
class BackUp {
 public:
  static constexpr double speed = 0.5;  ///< m/s

  void reset() noexcept { *this = {}; }

  /// A control period passes: is a plan `free`, and at what speed (m/s) does the car move? Returns whether it
  /// is to go back now.
  bool update(bool free, double speed_now, double period) noexcept {
    if (back_for_ > 0) {
      back_for_ += period;
      if (back_for_ > most_ || (free && back_for_ > least_)) {
        back_for_ = standing_for_ = driving_for_ = 0;
        least_ = std::min(2 * least_, furthest);
        most_ = std::max(most_, least_);
      }
    } else {
      const bool stands = std::abs(speed_now) <= standing;
      standing_for_ = free || !stands ? 0 : standing_for_ + period;
      driving_for_ += stands ? 0 : period;
      if (driving_for_ > relief) least_ = shortest, most_ = longest;
      if (standing_for_ >= patience) back_for_ = period;
    }
    return back_for_ > 0;
  }

 private:
  static constexpr double standing = 0.1;  ///< m/s, slower is standing
  static constexpr double patience = 0.3;  ///< s of standing before it goes back
  static constexpr double shortest = 0.6;  ///< s of going back at least, at first
  static constexpr double longest = 2.0;   ///< s of going back at most, at first
  static constexpr double furthest = 4.0;  ///< s of going back, ever
  static constexpr double relief = 3.0;    ///< s of driving after which it has come out

  double least_ = shortest, most_ = longest;   ///< s of going back
  double standing_for_ = 0, driving_for_ = 0;  ///< s
  double back_for_ = 0;                        ///< s; 0 while it does not go back
};

}  // namespace slalom::vehicle::detail
