#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "slalom/navigation/path_planner.hpp"

namespace slalom::navigation::detail {

/// Places that count as closed although the costmap shows room: dead ends, and the place of a meeting.
class ClosedPlaces {
 public:
  bool has_dead_ends() const noexcept { return dead_ends_ > 0; }
  void forget_dead_ends() noexcept { dead_ends_ = 0; }
  /// Adds a dead end; the last four count.
  void add_dead_end(const maps::Point& middle) noexcept {
    if (dead_ends_ == max_dead_ends) {
      std::copy(places_.begin() + 1, places_.begin() + max_dead_ends, places_.begin());
      --dead_ends_;
    }
    places_[dead_ends_++] = {middle, PathPlanner::dead_end_radius};
  }
  /// Closes a place until `end_meeting`.
  void begin_meeting(const ClosedPlace& place) noexcept {
    places_[dead_ends_] = place;
    meetings_ = 1;
  }
  void end_meeting() noexcept { meetings_ = 0; }

  std::span<const ClosedPlace> all() const noexcept { return {places_.data(), dead_ends_ + meetings_}; }
  bool contain(const maps::Point& point) const noexcept {
    const auto places = all();
    return std::any_of(places.begin(), places.end(),
                       [&](const ClosedPlace& each) { return distance(point, each.middle) < each.radius; });
  }

 private:
  static constexpr std::size_t max_dead_ends = 4;
  std::array<ClosedPlace, max_dead_ends + 1> places_{};
  std::size_t dead_ends_ = 0, meetings_ = 0;
};

}  // namespace slalom::navigation::detail
