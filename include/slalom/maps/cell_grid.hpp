#pragma once

#include <bit>

#include "slalom/core/grid_view.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/sequence_batch.hpp"

namespace slalom::maps {

/// The place of the cells of a map around the car. The convention is that of ROS grid_map: rows run along x,
/// columns along y, and row 0, column 0 is the cell with the LARGEST x and y; the upper edges of the map are
/// inside, the lower ones are not. The formulas keep the order of operations of grid_map 1.6.4, so that a
/// position on the corner of four cells falls into the same cell.
struct GridGeometry {
  int rows = 0;           ///< cells along x
  int columns = 0;        ///< cells along y
  double resolution = 0;  ///< m per cell
  double center_x = 0;    ///< m
  double center_y = 0;    ///< m

  double length_x() const { return resolution * rows; }     ///< m
  double length_y() const { return resolution * columns; }  ///< m

  /// x of the centres of a row's cells, m.
  double cell_x(int row) const { return center_x + 0.5 * length_x() - 0.5 * resolution - resolution * row; }
  /// y of the centres of a column's cells, m.
  double cell_y(int column) const {
    return center_y + 0.5 * length_y() - 0.5 * resolution - resolution * column;
  }

  /// The row of the cells at x (m); -1 outside the map and for NaN.
  int row(double x) const { return index(x, center_x, rows); }
  /// The column of the cells at y (m); -1 outside the map and for NaN.
  int column(double y) const { return index(y, center_y, columns); }

 private:
  int index(double position, double center, int count) const {
    const double length = resolution * count, half = 0.5 * length;
    const double from_edge = -((position - center) - half);
    if (!(from_edge >= 0 && from_edge < length)) return -1;
    const int i = saturate_cast<int>(-(((position - half) - center) / resolution));
    return i < count ? i : count - 1;
  }
};

/// Cells of `Layers` float32 values each, row-major, with a ring of cells all round that hold the values for
/// "outside": an index clamped to [-1, rows] x [-1, columns] needs no mask. A row takes a power of two of
/// cells, so that an index is a shift and an addition. The first value is aligned to 64 bytes.
template <int Layers>
class CellGrid {
 public:
  /// Cells and border ring with all values 0.
  CellGrid(int rows, int columns)
      : rows_(rows),
        stride_log2_(std::bit_width(static_cast<unsigned>(columns + 1))),
        cells_((std::ptrdiff_t{rows + 2} << stride_log2_) * Layers) {}

  /// The values of a cell; row -1 .. rows, column -1 .. columns.
  float* at(int row, int column) { return cells_.data() + offset(row, column); }
  /// The values of a cell; row -1 .. rows, column -1 .. columns.
  const float* at(int row, int column) const { return cells_.data() + offset(row, column); }

  /// The ring's first cell; one row has 2^stride_log2() cells.
  const float* data() const { return cells_.data(); }
  /// Base-2 logarithm of the number of cells from one row to the next.
  int stride_log2() const { return stride_log2_; }

  /// For the look-ups of rollouts; valid while this lives and the geometry is that of the cells.
  GridView<Layers> view(const GridGeometry& geometry) const {
    return {data(),           geometry.rows,       geometry.columns,
            stride_log2_,     geometry.resolution, geometry.center_x,
            geometry.center_y};
  }

  /// Sets every cell, the ring included.
  void fill(const float (&values)[Layers]) {
    float* cell = cells_.data();
    for (std::size_t i = 0, count = static_cast<std::size_t>(rows_ + 2) << stride_log2_; i < count; ++i) {
      for (int layer = 0; layer < Layers; ++layer) *cell++ = values[layer];
    }
  }

 private:
  std::size_t offset(int row, int column) const {
    return ((static_cast<std::size_t>(row + 1) << stride_log2_) + static_cast<std::size_t>(column + 1)) *
           Layers;
  }

  int rows_;
  int stride_log2_;
  AlignedBuffer cells_;
};

}  // namespace slalom::maps
