#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "slalom/navigation/path_planner.hpp"

namespace slalom::navigation::detail {

/// Places where no way leads although the costmap shows room: dead ends, and one where somebody is met.
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
  /// Closes a place for as long as this lives.
  class Meeting {
   public:
    Meeting(ClosedPlaces& places, const ClosedPlace& place) noexcept : places_(places) {
      places_.places_[places_.dead_ends_] = place;
      places_.meetings_ = 1;
    }
    ~Meeting() { places_.meetings_ = 0; }
    Meeting(const Meeting&) = delete;
    Meeting& operator=(const Meeting&) = delete;

   private:
    ClosedPlaces& places_;
  };

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
