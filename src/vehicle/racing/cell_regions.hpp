#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace slalom::vehicle::detail {

/// A connected region of cells.
struct CellRegion {
  int left = 0, right = 0, bottom = 0, top = 0;  ///< its least and greatest columns and rows
  bool at_border = false;                        ///< whether it has a cell on the border of the grid
};

/// The connected regions of the cells that have a property.
class CellRegions {
 public:
  /// `diagonal`: cells that share a corner are neighbours too.
  template <class Property>
  CellRegions(int width, int height, bool diagonal, const Property& has)
      : width_(width), height_(height), label_(static_cast<std::size_t>(width) * height, -1) {
    std::vector<std::pair<int, int>> front;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (label_[index(x, y)] >= 0 || !has(x, y)) continue;
        const int number = static_cast<int>(regions_.size());
        CellRegion region{x, x, y, y, false};
        label_[index(x, y)] = number;
        front.assign(1, {x, y});
        while (!front.empty()) {
          const auto [column, row] = front.back();
          front.pop_back();
          add(region, column, row);
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
              const int nx = column + dx, ny = row + dy;
              if ((!diagonal && dx != 0 && dy != 0) || nx < 0 || ny < 0 || nx >= width || ny >= height)
                continue;
              if (label_[index(nx, ny)] >= 0 || !has(nx, ny)) continue;
              label_[index(nx, ny)] = number;
              front.emplace_back(nx, ny);
            }
        }
        regions_.push_back(region);
      }
  }

  /// The number of a cell's region, -1 without the property.
  int at(int column, int row) const { return label_[index(column, row)]; }
  const std::vector<CellRegion>& regions() const { return regions_; }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }

  void add(CellRegion& region, int column, int row) const {
    region.left = std::min(region.left, column);
    region.right = std::max(region.right, column);
    region.bottom = std::min(region.bottom, row);
    region.top = std::max(region.top, row);
    region.at_border |= column == 0 || row == 0 || column + 1 == width_ || row + 1 == height_;
  }

  int width_, height_;
  std::vector<int> label_;
  std::vector<CellRegion> regions_;
};

}  // namespace slalom::vehicle::detail
