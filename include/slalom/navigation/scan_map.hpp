#pragma once

#include <span>

#include "slalom/maps/occupancy_grid.hpp"

namespace slalom::navigation {

/// The ranges of a planar scanner that looks all round.
struct RangeScan {
  maps::Pose pose;                 ///< pose of the scanner, map frame
  std::span<const double> ranges;  ///< m; the beams are evenly spread, the first along the scanner's x axis
  double max_range = 0;            ///< m; a range that is not below it is a beam that hit nothing
};

/// A map and the additions of scans: beams clear the cells that they cross and mark the cell where they end.
/// Obstacles of the map are never cleared. After construction nothing allocates.
class ScanMap {
 public:
  /// Starts with this map. Throws std::invalid_argument if its origin is turned or it has no cells.
  explicit ScanMap(maps::OccupancyGrid known);

  /// Adds a scan. Beams whose range is not finite or not above 0 are dropped, all if the pose is not
  /// plausible. A beam from off the map clears and marks the cells of the map that it crosses.
  void add(const RangeScan& scan) noexcept;

  const maps::OccupancyGrid& grid() const noexcept { return seen_; }  ///< the map with the additions

 private:
  void clear(const maps::Point& from, double cosine, double sine, double range) noexcept;

  maps::OccupancyGrid known_, seen_;
};

}  // namespace slalom::navigation
