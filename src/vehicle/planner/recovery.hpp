#pragma once

#include <algorithm>
#include <cmath>

namespace slalom::vehicle::detail {

/// Decides when to reverse. If the car makes no progress along the course, it reverses, steered by the same
/// solver, and drives on. If that does not help, it reverses further. Plans are urgent from the moment when
/// the car crawls or stands until it is past that place, so that driving around costs less than standing.
class Recovery {
 public:
  /// Largest speed in reverse, m/s. It is low because a reversing car steers with its rear. The car of
  /// f1tenth_gym diverges above 0.5 m/s (sim::DynamicsOptions::gym).
  static constexpr double speed = 0.45;

  void reset() noexcept { *this = {}; }

  bool reversing() const noexcept { return reversing_; }
  /// Whether it began to reverse in the last update.
  bool begins_to_reverse() const noexcept { return reversing_ && reversing_for_ == 0; }
  /// Whether the car is not yet well past the place where it crawled or stood.
  bool leaving() const noexcept { return leaving_; }
  /// Whether the car drives on after reversing and is not yet well past that place.
  bool tries_again() const noexcept { return trying_again_ && !reversing_; }

  /// The share of the margin around the body that plans keep: less where the car was too near to obstacles
  /// even to reverse, until it is well past that place. A car whose margin just touches an obstacle finds no
  /// plan without a collision in either direction, though there is room.
  double margin_share() const noexcept { return confined_ ? confined_margin : 1; }

  /// Begins to watch anew from this place along the course (m), after a manoeuvre: nothing counts as
  /// standing.
  void watch_from(double arc) noexcept {
    reversing_ = false;
    furthest_ = arc;
    since_progress_ = standing_for_ = crawling_for_ = 0;
  }

  /// Advances by one control period (s). `arc` is the place of the car along the course (m), and `length`
  /// that of a closed course (m), 0 if it is open. The car drives at `speed_now` and would drive at
  /// `free_speed` (m/s) if the path were free. `waits` tells that a moving car is close ahead, so the own car
  /// is not stuck. Returns whether to reverse now.
  bool update(double arc, double length, double speed_now, double free_speed, double period,
              bool waits = false) noexcept {
    if (!started_) furthest_ = arc, started_ = true;
    const bool crawls = speed_now < crawling * free_speed || speed_now < standing;
    crawling_for_ = crawls && !reversing_ && !waits ? crawling_for_ + period : 0;
    if (reversing_) {
      reverse(speed_now, period, arc);
    } else {
      watch(arc, length, speed_now, waits ? 0 : period);
    }
    return reversing_;
  }

 private:
  static constexpr double progress = 0.5;                 ///< m, counts as progress
  static constexpr double patience = 3;                   ///< s without progress
  static constexpr double standing = 0.15;                ///< m/s, a slower car stands
  static constexpr double crawling = 0.4;                 ///< share of the free speed: a slower car crawls
  static constexpr double hesitation = 0.5;               ///< s of crawling
  static constexpr double stand_still = 0.7;              ///< s of standing
  static constexpr double shortest = 0.8, longest = 3.0;  ///< m to reverse
  static constexpr double moved = 0.1;                    ///< m; a car that reverses less is confined
  static constexpr double confined_margin = 0.2;          ///< share of the margin that a confined car keeps
  static constexpr double slowest_try = 10;               ///< s of reversing at most
  static constexpr double relief = 4;  ///< m of progress after which the dead end counts as left

  /// Returns the distance (m) from one place to another along the course.
  static double way(double from, double to, double length) noexcept {
    return length > 0 ? std::remainder(to - from, length) : to - from;
  }
  /// Watches a car that drives forwards, and decides whether it must reverse.
  void watch(double arc, double length, double speed_now, double period) noexcept {
    note_progress(way(furthest_, arc, length), arc, period);
    forget_trouble(arc, length);
    standing_for_ = std::abs(speed_now) < standing && period > 0 ? standing_for_ + period : 0;
    const bool no_progress = since_progress_ >= patience;
    if (crawling_for_ >= hesitation || no_progress) {
      if (!leaving_ || way(stuck_, arc, length) > 0) stuck_ = arc;
      leaving_ = true;
    }
    if (no_progress || standing_for_ >= stand_still) begin_reversing(arc, length);
  }
  void note_progress(double ahead, double arc, double period) noexcept {
    const bool was_moved = std::abs(ahead) > 10;  // the car was put somewhere else
    if (was_moved) leaving_ = trying_again_ = confined_ = false;
    since_progress_ = was_moved ? period : ahead > progress ? 0 : since_progress_ + period;
    if (was_moved || ahead > progress) furthest_ = arc;
  }
  /// Past the places of trouble, everything is as usual again.
  void forget_trouble(double arc, double length) noexcept {
    if (leaving_ && way(stuck_, arc, length) > relief) {
      leaving_ = confined_ = false;
      distance_ = shortest;
    }
    if (way(reversed_at_, arc, length) > relief) trying_again_ = false;
  }
  void begin_reversing(double arc, double length) noexcept {
    if (!trying_again_ || way(reversed_at_, arc, length) > 0) reversed_at_ = arc;
    reversing_ = trying_again_ = true;
    driven_ = reversing_for_ = standing_for_ = 0;
  }
  void reverse(double speed_now, double period, double arc) noexcept {
    driven_ += std::max(-speed_now, 0.0) * period;
    reversing_for_ += period;
    standing_for_ = std::abs(speed_now) < standing ? standing_for_ + period : 0;
    if (driven_ < distance_ && standing_for_ < stand_still && reversing_for_ < slowest_try) return;
    reversing_ = false;
    confined_ |= driven_ < moved;
    since_progress_ = standing_for_ = 0;
    furthest_ = arc;
    distance_ = std::min(1.6 * distance_, longest);
  }

  bool started_ = false, reversing_ = false, leaving_ = false, trying_again_ = false, confined_ = false;
  double furthest_ = 0, stuck_ = 0, reversed_at_ = 0;                 ///< m along the course
  double since_progress_ = 0, standing_for_ = 0, reversing_for_ = 0;  ///< s
  double crawling_for_ = 0;                                           ///< s
  double driven_ = 0;                                                 ///< m in reverse
  double distance_ = shortest;                                        ///< m to reverse next time
};

}  // namespace slalom::vehicle::detail
