#pragma once

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {

/// Decides when to reverse out of a dead end. If the car stands and every plan collides, it reverses straight
/// for a short time to gain room. If it soon stands again, it reverses for longer.
class BackUp {
 public:
  static constexpr double speed = 0.5;  ///< m/s

  void reset() noexcept { *this = {}; }

  /// Advances by one control period (s). `free` tells whether a plan has no collision; `speed_now` is in m/s.
  /// Returns whether to reverse now.
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
  static constexpr double standing = 0.1;  ///< m/s, a slower car stands
  static constexpr double patience = 0.3;  ///< s of standing before it reverses
  static constexpr double shortest = 0.6;  ///< s of reversing at least, at first
  static constexpr double longest = 2.0;   ///< s of reversing at most, at first
  static constexpr double furthest = 4.0;  ///< s of reversing, upper bound
  static constexpr double relief = 3.0;    ///< s of driving after which the dead end counts as left

  double least_ = shortest, most_ = longest;   ///< s of reversing
  double standing_for_ = 0, driving_for_ = 0;  ///< s
  double back_for_ = 0;                        ///< s; 0 unless it reverses
};

}  // namespace slalom::vehicle::detail
