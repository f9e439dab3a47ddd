#pragma once

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {

/// When to drive backwards: where the car makes no progress along the course, whatever its plans say. Then it
/// reverses, steered by the same solver, and drives on; if that did not help, it reverses further.
class Recovery {
 public:
  static constexpr double speed = 1.0;  ///< m/s at most, in reverse

  void reset() noexcept { *this = {}; }

  bool reversing() const noexcept { return reversing_; }

  /// Advances by one control period (s), with where the car is along the course (m) of this length (m), 0
  /// where it is not closed, and its speed (m/s). Returns whether to reverse now.
  bool update(double arc, double length, double speed_now, double period) noexcept {
    if (!started_) furthest_ = arc, started_ = true;
    double ahead = arc - furthest_;
    if (length > 0) ahead = std::remainder(ahead, length);
    if (reversing_) {
      reverse(speed_now, period, arc);
    } else {
      watch(ahead, arc, speed_now, period);
    }
    return reversing_;
  }

 private:
  static constexpr double progress = 0.5;                 ///< m, that counts as getting on
  static constexpr double patience = 3;                   ///< s without progress
  static constexpr double standing = 0.15;                ///< m/s, a slower car stands
  static constexpr double stand_still = 0.7;              ///< s of standing
  static constexpr double shortest = 0.8, longest = 3.0;  ///< m to reverse
  static constexpr double slowest_try = 5;                ///< s of reversing at most
  static constexpr double relief = 4;                     ///< m of progress after which the dead end is left

  void watch(double ahead, double arc, double speed_now, double period) noexcept {
    if (std::abs(ahead) > 10) furthest_ = arc, ahead = 0;  // put somewhere else
    since_progress_ += period;
    standing_for_ = std::abs(speed_now) < standing ? standing_for_ + period : 0;
    if (ahead > progress) {
      furthest_ = arc;
      since_progress_ = 0;
      left_behind_ += ahead;
      if (left_behind_ > relief) distance_ = shortest;
    }
    if (since_progress_ < patience && standing_for_ < stand_still) return;
    reversing_ = true;
    driven_ = reversing_for_ = standing_for_ = 0;
  }
  void reverse(double speed_now, double period, double arc) noexcept {
    driven_ += std::max(-speed_now, 0.0) * period;
    reversing_for_ += period;
    standing_for_ = std::abs(speed_now) < standing ? standing_for_ + period : 0;
    if (driven_ < distance_ && standing_for_ < stand_still && reversing_for_ < slowest_try) return;
    reversing_ = false;
    since_progress_ = standing_for_ = left_behind_ = 0;
    furthest_ = arc;
    distance_ = std::min(1.6 * distance_, longest);
  }

  bool started_ = false, reversing_ = false;
  double furthest_ = 0;                                               ///< m along the course
  double since_progress_ = 0, standing_for_ = 0, reversing_for_ = 0;  ///< s
  double driven_ = 0;                                                 ///< m in reverse
  double left_behind_ = 0;                                            ///< m of progress since it reversed
  double distance_ = shortest;                                        ///< m to reverse next time
};

}  // namespace slalom::vehicle::detail
