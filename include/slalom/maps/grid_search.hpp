#pragma once

#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/closed_discs.hpp"
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
  /// Sets the prices for a body whose room (m) in the middle of a cell is `room(point)`.
  template <class Room>
  void set_prices(Room&& room, double cautious) noexcept {
    for (int cell = 0; cell < size(); ++cell)
      prices_[static_cast<std::size_t>(cell)] = price_of(room(centre_of(cell)), cautious);
  }
  /// The price where a body has so much room (m): 1 if it is `cautious` (m) or more, up to 5 if it is less.
  /// If it is below 0, the cell is closed.
  static float price_of(double room, double cautious) noexcept {
    const double nearness = std::clamp(1 - room / cautious, 0.0, 1.0);
    return room < 0 ? 0.0F : 1 + (dearest - 1) * static_cast<float>(nearness);
  }
  /// Closes the cells in a place.
  void close(const ClosedDisc& place) noexcept;
  /// Opens the closed cells within `reach` (m) of a point, at the highest price.
  void open_around(const Point& point, double reach) noexcept;
  /// Calls `visit(cell)` with every cell whose middle is within `reach` (m) of a point.
  template <class Visit>
  void visit_around(const Point& point, double reach, Visit&& visit) const noexcept {
    const auto index = [&](double offset, int most) {
      return std::clamp(offset / cell_size_, 0.0, most - 1.0);
    };
    const Point from{point.x - reach - corner_.x, point.y - reach - corner_.y};
    const auto last_column = static_cast<int>(index(from.x + 2 * reach, columns_)),
               last_row = static_cast<int>(index(from.y + 2 * reach, rows_));
    for (auto row = static_cast<int>(index(from.y, rows_)); row <= last_row; ++row)
      for (auto column = static_cast<int>(index(from.x, columns_)); column <= last_column; ++column) {
        const int cell = row * columns_ + column;
        if (distance(centre_of(cell), point) <= reach) visit(static_cast<std::size_t>(cell));
      }
  }
  /// Computes the costs of all cells that can be reached from one, which may be closed itself.
  void spread(int from) noexcept {
    begin(from);
    advance(std::numeric_limits<int>::max());
  }
  /// Begins what `spread` does.
  void begin(int from) noexcept;
  /// Goes on from at most so many cells. Returns whether the costs of all cells are known.
  bool advance(int cells) noexcept;
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

  static constexpr float dearest = 5;  ///< price beside an obstacle

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
