#pragma once

#include <span>
#include <vector>

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::maps {

/// Cheapest ways over a grid of square cells, in each of which driving 1 m has a price: Dijkstra's search
/// (Numerische Mathematik 1, 1959) over the eight neighbours of a cell, and paths with rounded corners. Cells
/// are numbered along x, then along y. After construction nothing allocates.
class GridSearch {
 public:
  /// A grid of so many cells along x and y, and paths of at most so many points.
  GridSearch(int columns, int rows, double cell_size, std::size_t max_points);

  /// Moves the corner of the grid with the least x and y, m.
  void set_corner(const Point& corner) noexcept { corner_ = corner; }
  /// Number of cells.
  int size() const noexcept { return static_cast<int>(prices_.size()); }
  /// The middle of a cell, m.
  Point centre_of(int cell) const noexcept;
  /// The cell at a position (m); -1 off the grid.
  int cell_at(const Point& point) const noexcept;

  /// The prices of the cells for driving 1 m, to be set before `spread`; not above 0: closed.
  std::span<float> prices() noexcept { return prices_; }
  /// Computes the costs of all cells that can be reached from one, which may be closed itself.
  void spread(int from) noexcept;
  /// The cost of reaching a cell; infinite where it cannot be reached.
  float cost(int cell) const noexcept { return costs_[static_cast<std::size_t>(cell)]; }
  bool reached(int cell) const noexcept;  ///< whether the last search reached it

  /// The cheapest path to a cell that was reached: straight from corner to corner, with points about
  /// `spacing` (m) apart, and its corners rounded by moving averages. The point of the goal is not part of
  /// it. Stays valid until the next call.
  std::span<const Point> path_to(int goal, double spacing) noexcept;

 private:
  struct Reached {
    float cost;
    int cell;
    bool operator<(const Reached& other) const noexcept { return cost > other.cost; }
  };

  bool is_clear(int from, int to) const noexcept;
  void smooth() noexcept;

  int columns_, rows_;
  double cell_size_;  ///< m
  std::size_t max_points_;
  Point corner_;
  std::vector<float> prices_;      ///< price of driving 1 m in each cell
  std::vector<float> costs_;       ///< cost of reaching each cell
  std::vector<int> previous_;      ///< cell before each on the cheapest path; -1 at its start
  ReservedVector<Reached> queue_;  ///< a heap
  ReservedVector<int> corners_;
  ReservedVector<Point> path_, smoothed_;
};

}  // namespace slalom::maps
