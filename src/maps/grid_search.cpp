#include "slalom/maps/grid_search.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::maps {

namespace {

constexpr int smoothing_reach = 3, smoothing_rounds = 2;  // points
constexpr float unreached = std::numeric_limits<float>::infinity();

}  // namespace

GridSearch::GridSearch(int columns, int rows, double cell_size, std::size_t max_points)
    : columns_(columns),
      rows_(rows),
      cell_size_(cell_size),
      max_points_(max_points),
      prices_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)),
      costs_(prices_.size(), unreached),
      previous_(prices_.size()) {
  queue_.reserve(8 * prices_.size());
  corners_.reserve(prices_.size());
  path_.reserve(max_points);
  smoothed_.reserve(max_points);
}

Point GridSearch::centre_of(int cell) const noexcept {
  const int column = cell % columns_, row = cell / columns_;
  return {corner_.x + (column + 0.5) * cell_size_, corner_.y + (row + 0.5) * cell_size_};
}

int GridSearch::cell_at(const Point& point) const noexcept {
  const double column = std::floor((point.x - corner_.x) / cell_size_),
               row = std::floor((point.y - corner_.y) / cell_size_);
  if (!(column >= 0 && column < columns_ && row >= 0 && row < rows_)) return -1;
  return saturate_cast<int>(row) * columns_ + saturate_cast<int>(column);
}

bool GridSearch::reached(int cell) const noexcept {
  return cost(cell) < unreached;
}

void GridSearch::close(const ClosedDisc& place) noexcept {
  visit_around(place.middle, place.radius, [&](std::size_t cell) { prices_[cell] = 0; });
}

void GridSearch::open_around(const Point& point, double reach) noexcept {
  visit_around(point, reach, [&](std::size_t cell) {
    if (!(prices_[cell] > 0)) prices_[cell] = dearest;
  });
}

void GridSearch::begin(int from, const Point& towards, double weight) noexcept {
  std::fill(costs_.begin(), costs_.end(), unreached);
  weight_ = static_cast<float>(weight);
  towards_x_ = static_cast<float>((towards.x - corner_.x) / cell_size_ - 0.5);
  towards_y_ = static_cast<float>((towards.y - corner_.y) / cell_size_ - 0.5);
  queue_.assign(1, {away(from), from});
  costs_[from] = 0;
  previous_[from] = -1;
}

/// Whether no cell on the straight line between two cells is closed or has a higher price than both of them:
/// the line may go along an obstacle, but not nearer to it.
bool GridSearch::is_clear(int from, int to) const noexcept {
  const Point a = centre_of(from), b = centre_of(to);
  const float most = std::max(prices_[from], prices_[to]);
  const int steps = saturate_cast<int>(std::ceil(std::hypot(b.x - a.x, b.y - a.y) / (0.5 * cell_size_)));
  for (int i = 1; i < steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const int cell = cell_at({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)});
    const float price = cell < 0 ? 0 : prices_[cell];
    if (!(price > 0) || price > most) return false;
  }
  return true;
}

std::span<const Point> GridSearch::path_to(int goal, double spacing) noexcept {
  corners_.clear();
  for (int cell = goal; cell >= 0; cell = previous_[cell]) corners_.push_back(cell);
  std::reverse(corners_.begin(), corners_.end());
  path_.clear();
  for (std::size_t at = 0; at + 1 < corners_.size() && path_.size() < max_points_;) {
    std::size_t next = at + 1;
    while (next + 1 < corners_.size() && is_clear(corners_[at], corners_[next + 1])) ++next;
    const Point a = centre_of(corners_[at]), b = centre_of(corners_[next]);
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const int parts = std::max(1, saturate_cast<int>(std::round(length / spacing)));
    for (int i = 0; i < parts && path_.size() < max_points_; ++i) {
      const double share = static_cast<double>(i) / parts;
      path_.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)});
    }
    at = next;
  }
  smooth();
  return path_;
}

/// Rounds the corners.
void GridSearch::smooth() noexcept {
  const int count = static_cast<int>(path_.size());
  for (int round = 0; round < smoothing_rounds; ++round) {
    smoothed_.assign(path_.begin(), path_.end());
    for (int i = 1; i + 1 < count; ++i) {
      const int reach = std::min({smoothing_reach, i, count - 1 - i});
      Point sum{0, 0};
      for (int k = i - reach; k <= i + reach; ++k) {
        sum.x += path_[k].x;
        sum.y += path_[k].y;
      }
      smoothed_[i] = {sum.x / (2 * reach + 1), sum.y / (2 * reach + 1)};
    }
    path_.swap(smoothed_);
  }
}

}  // namespace slalom::maps
