#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "navigation/path_guide.hpp"
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

/// The open part of the path ahead, as far as a costmap and the closed places tell. Refers to its arguments.
class PathAhead {
 public:
  static constexpr double min_rejoin = 0.5;  ///< m of path with room that a detour needs where it ends

  PathAhead(const PathGuide& guide, const PathPlanner& planner, const ClosedPlaces& places,
            const Costmap& costmap) noexcept
      : guide_(guide), planner_(planner), places_(places), costmap_(costmap) {}

  /// The first closed point within a length (m) of path; the number of points if there is none.
  std::size_t first_closed(double length) const noexcept {
    const std::size_t last = std::min(points().size() - 1, guide_.nearest() + guide_.points_for(length));
    for (std::size_t i = guide_.nearest(); i <= last; ++i)
      if (is_closed(i)) return i;
    return points().size();
  }
  /// Whether a point is closed: the body has no room there, or it is in a closed place.
  bool is_closed(std::size_t i) const noexcept {
    return (planner_.knows(costmap_, place(i)) && !planner_.has_room(costmap_, place(i))) ||
           places_.contain(place(i));
  }
  /// Whether a detour may end at a point: the path is open from there on for a while, or to its end.
  bool can_rejoin(std::size_t point) const noexcept {
    const std::size_t last = std::min(points().size() - 1, point + guide_.points_for(min_rejoin));
    for (std::size_t i = point; i <= last; ++i)
      if (is_closed(i)) return false;
    return true;
  }
  /// Whether the path leaves the costmap before a detour around its closed point could end, and the robot is
  /// more than `distance` (m) before that point.
  bool opens_off_the_map(std::size_t closed, double distance) const noexcept {
    if (guide_.step() * static_cast<double>(closed - guide_.nearest()) <= distance) return false;
    for (std::size_t i = closed + 1; i < points().size(); ++i) {
      if (!planner_.knows(costmap_, place(i))) return true;
      if (can_rejoin(i)) return false;
    }
    return false;
  }

 private:
  std::span<const maps::Pose> points() const noexcept { return guide_.points(); }
  maps::Point place(std::size_t i) const noexcept { return {points()[i].x, points()[i].y}; }
  const PathGuide& guide_;
  const PathPlanner& planner_;
  const ClosedPlaces& places_;
  const Costmap& costmap_;
};

}  // namespace slalom::navigation::detail
