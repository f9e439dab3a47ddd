#pragma once

#include <optional>

#include "slalom/maps/distance_field.hpp"
#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/sim/laps.hpp"
#include "slalom/sim/shapes.hpp"

namespace slalom::sim {

/// The constant part of a world: walls, the fields computed from them and the path along which laps are
/// measured. Expensive to construct, immutable, and shared by any number of worlds and threads.
class Track {
 public:
  /// Throws std::invalid_argument on a map of no size or more than 32766 cells along a side, a resolution
  /// that is not positive, an origin that is not finite, a cell count that does not fit, or no free cell.
  /// Unknown cells are free. `outside_is_wall`: the border of the map stops cars and beams; else a beam that
  /// leaves the map has no return.
  explicit Track(maps::OccupancyGrid grid, std::optional<LapPath> lap_path = {}, bool outside_is_wall = true);

  const maps::OccupancyGrid& grid() const noexcept { return grid_; }  ///< the map
  /// Distance to the nearest wall, m.
  const maps::DistanceField& distance() const noexcept { return distance_; }
  /// Path for counting laps, or null.
  const LapPath* lap_path() const noexcept { return lap_path_ ? &*lap_path_ : nullptr; }
  /// Whether the border of the map stops cars and beams.
  bool outside_is_wall() const noexcept { return outside_is_wall_; }

  /// Whether a cell is a wall: column -1 .. width, row -1 .. height. The ring of cells round the map counts
  /// as wall even where `outside_is_wall` is off.
  bool is_wall(int column, int row) const noexcept { return clearance_at(column, row) < 0; }

  bool in_wall(const maps::Point& point) const noexcept;  ///< whether a point of the map frame lies in a wall

  /// Whether a body collides with a wall: whether the rectangle overlaps an obstacle cell or the outside.
  bool collides_with_wall(const Box& box) const noexcept;

  /// The distance (m) from a point to the nearest wall, with an error of at most one cell; 0 in a
  /// wall, infinite without any wall. Outside the map it is 0 with `outside_is_wall`, else infinite.
  double distance_to_wall(const maps::Point& point) const noexcept;

  /// The distance (m) that f1tenth_gym takes for that from a point to the nearest wall.
  double gym_distance(const maps::Point& point) const noexcept;

  /// A point in cells of the grid: column and row with fractions.
  maps::Point to_cells(const maps::Point& point) const noexcept {
    const double dx = point.x - grid_.origin.x, dy = point.y - grid_.origin.y;
    return {(cosine_ * dx + sine_ * dy) / grid_.resolution, (cosine_ * dy - sine_ * dx) / grid_.resolution};
  }
  /// Whether a point in cells lies on the map.
  bool contains(const maps::Point& cell) const noexcept {
    return cell.x >= 0 && cell.y >= 0 && cell.x < grid_.width && cell.y < grid_.height;
  }

  /// One entry per cell and a ring of cells round the map, row by row, `clearance_stride` a row: how far
  /// (1/64 cell, at most 500 cells) from any point of this cell there is no wall in any direction; negative
  /// in walls, `exit` on the ring where the outside is not a wall. One more entry at the end has no meaning.
  const std::vector<std::int16_t>& clearance() const noexcept { return clearance_; }
  /// Number of cells from one row of clearances to the next.
  int clearance_stride() const noexcept { return grid_.width + 2; }
  static constexpr int clearance_scale = 64;           ///< scale of clearances: cells times this
  static constexpr std::int16_t wall = -1, exit = -2;  ///< clearance of walls and of cells outside the map

 private:
  std::int16_t clearance_at(int column, int row) const noexcept {
    return clearance_[static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(clearance_stride()) +
                      static_cast<std::size_t>(column + 1)];
  }
  void make_clearance();

  maps::OccupancyGrid grid_;
  bool outside_is_wall_;
  std::optional<LapPath> lap_path_;
  maps::DistanceField distance_;
  std::vector<std::int16_t> clearance_;
  double cosine_ = 1;  ///< cosine of the grid's yaw
  double sine_ = 0;
};

}  // namespace slalom::sim
