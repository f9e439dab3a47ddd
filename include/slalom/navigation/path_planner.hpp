#pragma once

#include "slalom/maps/grid_search.hpp"
#include "slalom/maps/path_curve.hpp"
#include "slalom/navigation/costmap.hpp"

namespace slalom::navigation {

/// Finds cheapest paths over a costmap for a body that needs a corridor. Cells beside it, within 1.2 times
/// its half width, cost up to five times as much. After construction nothing allocates.
class PathPlanner {
 public:
  static constexpr std::size_t max_points = 4000;  ///< most points of a path, unless more are asked for
  static constexpr double spacing = maps::PathCurve::spacing;  ///< m, between the points of a path
  static constexpr double joint = 4 * spacing;  ///< m of its end, before a goal or another path

  /// For costmaps of this size, and a body with this half width (m).
  PathPlanner(const maps::GridGeometry& geometry, double half_width, std::size_t most_points = max_points);

  /// Whether the costmap covers all cells that the body touches at a point of a path.
  bool knows(const Costmap& costmap, const maps::Point& point) const noexcept;
  /// Whether there is room for the body there, where the path goes straight on.
  bool has_room(const Costmap& costmap, const maps::Point& point) const noexcept;

  /// Begins a search from a position over a costmap of the size given. Returns false if it is off the
  /// costmap. `kept` is a path that was followed before: cells further than 1.2 half widths from it cost 1.3
  /// times as much. No way leads through the `closed` discs. It goes `towards` a point at first. Cells within
  /// 1.2 half widths of the start count as free, or those up to the nearest free place.
  bool begin(const Costmap& costmap, const maps::Point& start, std::span<const maps::Pose> kept = {},
             std::span<const maps::ClosedDisc> closed = {}, const maps::Point* towards = nullptr) noexcept;
  /// Goes on from at most so many cells. Returns whether it has ended: then all costs are known.
  bool advance(const Costmap& costmap, int cells = std::numeric_limits<int>::max()) noexcept;
  bool is_searching() const noexcept { return is_searching_; }  ///< whether a search has begun and not ended
  void cancel() noexcept { is_searching_ = false; }             ///< ends a search without a result
  /// The least cost (m) of a way to a position if that is not known yet.
  double known(const maps::Point& point) const noexcept { return grid_.known(grid_.cell_at(point)); }
  /// The cost of a way to a position, m of free space; infinite if there is none.
  double cost_to(const maps::Point& point) const noexcept;
  /// A way, and its end if it is followed by a straight line off the costmap.
  struct Way {
    maps::Point end;  ///< m
    double cost = 0;  ///< m of free space, with that line; infinite if there is none
  };
  /// The cheapest way to a position off the costmap that costs less than `most`: to its edge, and straight
  /// on.
  Way way_off(const Costmap& costmap, const maps::Point& point, double most) const noexcept;
  /// The way to a position that can be reached, without that itself; empty if too long. Valid until the next
  /// call.
  std::span<const maps::Point> path_to(const maps::Point& point) noexcept;

 private:
  enum Mark : std::uint8_t { none, kept_way, closed_place };
  void price(const Costmap& costmap, int cell) noexcept;

  double half_width_;
  maps::GridGeometry geometry_;
  maps::GridSearch grid_;
  std::size_t most_points_;
  std::vector<Mark> marks_;  ///< [cell]
  float elsewhere_ = 1;      ///< factor of prices off the way that was kept
  bool is_searching_ = false;
};

/// A path to a goal: points about 0.05 m apart, each with its direction, and the goal. Empty if there is
/// none.
std::vector<maps::Pose> plan_path(const Costmap& costmap, const Footprint& footprint, const maps::Pose& start,
                                  const maps::Pose& goal);

}  // namespace slalom::navigation
