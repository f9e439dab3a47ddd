#pragma once

#include "slalom/maps/distance_field.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::vehicle::detail {

/// m, from a point to the edge of the nearest occupied cell, or also of an unknown one, at most `reach`.
double distance_to_wall(const maps::OccupancyGrid& map, const maps::Point& point, double reach,
                        bool unknown_is_wall);

/// The space of a map in which a car can drive.
class FreeSpace {
 public:
  /// Unknown cells are walls, but for spots of at most `spot` m that touch no occupied cell: gaps between
  /// beams. Cells outside the map are not walls.
  FreeSpace(const maps::OccupancyGrid& map, double spot);

  const maps::OccupancyGrid& map() const { return map_; }  ///< without the spots
  int spots() const { return spots_; }                     ///< number of unknown spots that count as free

  /// m, from a point to the nearest wall, to the edge of its cell; 0 in walls, negative outside the map.
  double clearance(const maps::Point& point) const;

  /// Whether clearance() is at least `keep` (m); faster.
  bool is_clear(const maps::Point& point, double keep) const;

  /// m, from the centre of a cell to the nearest wall; up to 0.2 cells too great where its corner is nearest.
  double clearance(int column, int row) const { return field_.at(column, row) - 0.5 * field_.resolution; }

  /// The centre of a cell, map frame.
  maps::Point centre(int column, int row) const;

  /// The column and row of a point as real numbers: whole at the centres of cells.
  maps::Point cell(const maps::Point& point) const;

 private:
  bool on_map(const maps::Point& at) const;

  /// m, from a point, in cells, to the centre of the nearest wall cell, between the values of cells.
  double to_centre(const maps::Point& at) const;

  maps::OccupancyGrid map_;
  int spots_ = 0;
  maps::DistanceField field_;
};

}  // namespace slalom::vehicle::detail
