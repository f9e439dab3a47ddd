#pragma once

#include <algorithm>
#include <limits>

#include "slalom/core/numbers/saturate_cast.hpp"
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

  static constexpr float unpriced = -1;  ///< price of a cell whose price a search asks for

  /// The prices of the cells for driving 1 m, to be set before `spread`; 0: closed.
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
      return saturate_cast<int>(std::clamp(offset / cell_size_, 0.0, most - 1.0));
    };
    const Point from{point.x - reach - corner_.x, point.y - reach - corner_.y};
    const int last_column = index(from.x + 2 * reach, columns_), last_row = index(from.y + 2 * reach, rows_);
    for (int row = index(from.y, rows_); row <= last_row; ++row)
      for (int column = index(from.x, columns_); column <= last_column; ++column) {
        const int cell = row * columns_ + column;
        if (distance(centre_of(cell), point) <= reach) visit(static_cast<std::size_t>(cell));
      }
  }
  /// Computes the costs of all cells that can be reached from one, which may be closed itself.
  void spread(int from) noexcept {
    begin(from);
    advance(std::numeric_limits<int>::max(), [](int) {});
  }
  /// Begins what `spread` does.
  void begin(int from) noexcept { begin(from, centre_of(from), 0); }
  /// The same, with the cells on the way to a point (m) first (A*).
  void begin(int from, const Point& towards) noexcept { begin(from, towards, cell_size_); }
  /// Goes on from at most so many cells. Returns whether the costs of all cells are known. `price(cell)` sets
  /// the price of an unpriced one.
  template <class Price>
  bool advance(int cells, Price&& price) noexcept;
  /// The least cost of a cell whose cost is not known yet.
  float known(int cell) const noexcept {
    return queue_.empty() ? std::numeric_limits<float>::infinity() : queue_.front().cost - away(cell);
  }
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
  void begin(int from, const Point& towards, double weight) noexcept;
  /// The distance (m) of a cell from the point towards which the search goes.
  float away(int cell) const noexcept {
    const int row = cell / columns_, column = cell % columns_;
    return weight_ *
           std::hypot(static_cast<float>(column) - towards_x_, static_cast<float>(row) - towards_y_);
  }
  void smooth() noexcept;

  int columns_, rows_;
  double cell_size_;  ///< m
  std::size_t max_points_;
  Point corner_;
  std::vector<float> prices_;      ///< price of driving 1 m in each cell
  std::vector<float> costs_;       ///< cost of reaching each cell
  std::vector<int> previous_;      ///< cell before each on the cheapest path; -1 at its start
  ReservedVector<Reached> queue_;  ///< a heap; costs with the distance that is left at least
  float towards_x_ = 0, towards_y_ = 0, weight_ = 0;  ///< cells, and m for each of them
  ReservedVector<int> corners_;
  ReservedVector<Point> path_, smoothed_;
};

template <class Price>
bool GridSearch::advance(int cells, Price&& price) noexcept {
  for (; cells > 0 && !queue_.empty(); --cells) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Reached here = queue_.back();
    queue_.pop_back();
    if (here.cost > costs_[here.cell] + away(here.cell)) continue;
    const int column = here.cell % columns_, row = here.cell / columns_;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = column + dx, y = row + dy;
        if ((dx == 0 && dy == 0) || x < 0 || x >= columns_ || y < 0 || y >= rows_) continue;
        const auto next = static_cast<std::size_t>(y * columns_ + x);
        if (prices_[next] < 0) price(static_cast<int>(next));
        if (!(prices_[next] > 0)) continue;
        const float step = static_cast<float>(cell_size_) * (dx != 0 && dy != 0 ? 1.41421356f : 1.0f);
        const float cost = costs_[here.cell] + step * prices_[next];
        if (cost >= costs_[next]) continue;
        costs_[next] = cost;
        previous_[next] = here.cell;
        queue_.push_back({cost + away(static_cast<int>(next)), static_cast<int>(next)});
        std::push_heap(queue_.begin(), queue_.end());
      }
  }
  return queue_.empty();
}

}  // namespace slalom::maps
