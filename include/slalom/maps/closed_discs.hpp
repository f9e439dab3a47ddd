#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "slalom/maps/pose.hpp"

namespace slalom::maps {

/// A disc through which no way leads.
struct ClosedDisc {
  Point middle;       ///< m
  double radius = 0;  ///< m
};

/// Places that count as closed although a map shows room: dead ends, and the place of a meeting.
class ClosedDiscs {
 public:
  bool has_dead_ends() const noexcept { return dead_ends_ > 0; }  ///< whether one counts
  void forget_dead_ends() noexcept { dead_ends_ = 0; }            ///< opens all
  /// Adds a dead end; the last four count.
  void add_dead_end(const ClosedDisc& place) noexcept {
    if (dead_ends_ == max_dead_ends) {
      std::copy(places_.begin() + 1, places_.begin() + max_dead_ends, places_.begin());
      --dead_ends_;
    }
    places_[dead_ends_++] = place;
  }
  /// Closes a place until `end_meeting`.
  void begin_meeting(const ClosedDisc& place) noexcept {
    places_[dead_ends_] = place;
    meetings_ = 1;
  }
  void end_meeting() noexcept { meetings_ = 0; }  ///< opens the place

  /// All closed places.
  std::span<const ClosedDisc> all() const noexcept { return {places_.data(), dead_ends_ + meetings_}; }
  /// Whether a point (m) is in one of them.
  bool contain(const Point& point) const noexcept {
    const auto places = all();
    return std::any_of(places.begin(), places.end(),
                       [&](const ClosedDisc& each) { return distance(point, each.middle) < each.radius; });
  }

 private:
  static constexpr std::size_t max_dead_ends = 4;
  std::array<ClosedDisc, max_dead_ends + 1> places_{};
  std::size_t dead_ends_ = 0, meetings_ = 0;
};

}  // namespace slalom::maps
