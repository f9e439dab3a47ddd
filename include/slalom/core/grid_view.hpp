#pragma once

#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom {

/// Metres along one axis of a map to cells, the ring included: cell = position * scale + offset, truncated.
struct GridAxis {
  double scale = 0, offset = 0;  ///< cell = scale times coordinate + offset
};

/// Nearest-cell look-ups in a map of `Layers` float32 values a cell (1, or 4: then one 128-bit load fetches a
/// cell), from scalar code and from SIMD lanes alike.
///
/// The grid is that of grid_map 1.6.4 (ROS): row 0 lies at the largest x, column 0 at the largest y, and the
/// upper edge of the map is inside, the lower one outside. All round lies a ring of cells that hold the
/// values for "outside", so an index that is out of range, or made from a NaN, is clamped into the ring and
/// needs no mask. Storage: (rows + 2) x 2^stride_log2 cells, 2^stride_log2 >= columns + 2, the ring included.
///
/// Lanes are float32, which at 1e6 m resolves 0.06 m. So rollouts look up a view that is `relative_to` a
/// point near the robot, and their positions are relative to it. That point itself then falls into the same
/// cell in lanes as in double, even where it lies on the edge between two cells.
template <int Layers>
class GridView {
 public:
  static_assert(Layers == 1 || Layers == 4);

  GridView() = default;
  /// `cells` begins with the ring; `rows` along x, `columns` along y, both without it; m per cell; m.
  GridView(const float* cells, int rows, int columns, int stride_log2, double resolution, double center_x,
           double center_y) noexcept
      : cells_(cells),
        rows_(rows),
        columns_(columns),
        stride_log2_(stride_log2),
        resolution_(resolution),
        center_x_(center_x),
        center_y_(center_y),
        last_row_(rows + 1),
        last_column_(columns + 1) {
    set_origin(0, 0);
  }

  /// Returns a view of the same cells for look-ups at positions relative to (x, y), m.
  GridView relative_to(double x, double y) const noexcept {
    GridView view = *this;
    view.set_origin(origin_x_ + x, origin_y_ + y);
    return view;
  }

  /// The first cell of the ring, at row -1 and column -1.
  const float* cells() const noexcept { return cells_; }
  /// Cells along x.
  int rows() const noexcept { return rows_; }
  /// Cells along y.
  int columns() const noexcept { return columns_; }
  /// A row has 2^stride_log2 cells in memory.
  int stride_log2() const noexcept { return stride_log2_; }
  /// Edge of a cell, m.
  double resolution() const noexcept { return resolution_; }
  /// Centre of the grid, x, m, in the frame of the map whatever the view is relative to.
  double center_x() const noexcept { return center_x_; }
  /// Centre of the grid, y, m, in the frame of the map.
  double center_y() const noexcept { return center_y_; }
  const GridAxis& rows_axis() const noexcept { return rows_axis_; }        ///< x to rows, ring included
  const GridAxis& columns_axis() const noexcept { return columns_axis_; }  ///< y to columns, the same

  /// Whether a storage index lies in the ring.
  bool in_ring(std::ptrdiff_t index) const noexcept {
    const std::ptrdiff_t row = index >> stride_log2_, column = index - (row << stride_log2_);
    return row == 0 || row == rows_ + 1 || column == 0 || column == columns_ + 1;
  }

  /// The storage index of the cell at (x, y), in the ring for positions outside.
  template <Scalar T>
  std::ptrdiff_t index(T x, T y) const {
    if constexpr (detail::gpu::computes<T>)
      return detail::gpu::cell_index(x * scale_.rounded() + offset_x_.rounded(),
                                     y * scale_.rounded() + offset_y_.rounded(), last_row_, last_column_,
                                     stride_log2_);
    const int row = axis_index(x + static_cast<T>(origin_x_), center_x_, rows_),
              column = axis_index(y + static_cast<T>(origin_y_), center_y_, columns_);
    return row == 0 || column == 0 ? 0 : (static_cast<std::ptrdiff_t>(row) << stride_log2_) + column;
  }
  /// Cell indices of positions, one for each lane.
  template <class Target>
  SLALOM_INLINE simd::IntPack<Target> index(const Pack<Target>& x, const Pack<Target>& y) const {
    using F = Pack<Target>;
    return index_of_cell(x * F(scale_) + F(offset_x_), y * F(scale_) + F(offset_y_));
  }
  /// Looks up a position in cells, as `rows_axis` and `columns_axis` give it.
  template <class Target>
  SLALOM_INLINE_CALLS simd::IntPack<Target> index_of_cell(const Pack<Target>& row_position,
                                                          const Pack<Target>& column_position) const {
    simd::IntPack<Target> row = clamped_index<Target>(row_position, last_row_);
    simd::Operations<Target>::shift_left(row.v, stride_log2_);
    return row + clamped_index<Target>(column_position, last_column_);
  }

 private:
  void set_origin(double x, double y) noexcept {
    origin_x_ = x;
    origin_y_ = y;
    rows_axis_ = axis(x, center_x_, rows_);
    columns_axis_ = axis(y, center_y_, columns_);
    scale_ = rows_axis_.scale;
    offset_x_ = rows_axis_.offset;
    offset_y_ = columns_axis_.offset;
  }
  /// For positions relative to `origin`. Where the origin lies on an edge between cells, `axis_index` decides
  /// in double; the offset, which is the origin's position in cells, is moved by one float32 to agree.
  GridAxis axis(double origin, double center, int count) const noexcept {
    const double offset = ((center - origin) + 0.5 * resolution_ * count) / resolution_ + 1.0;
    const int cell = axis_index(origin, center, count);
    if (cell == 0) return {-1.0 / resolution_, offset};
    const float rounded = static_cast<float>(offset), first = static_cast<float>(cell),
                last = std::nextafter(static_cast<float>(cell + 1), 0.0f);
    if (rounded >= first && rounded <= last) return {-1.0 / resolution_, offset};
    return {-1.0 / resolution_, static_cast<double>(std::clamp(rounded, first, last))};
  }
  /// Index along one axis, 1 ... count inside, 0 outside. In double this is exactly the order of operations
  /// of grid_map 1.6.4 (getIndexFromPosition and its inside test).
  template <Scalar T>
  int axis_index(T position, double center, int count) const {
    const T length = static_cast<T>(resolution_ * count), half = T(0.5) * length;
    const T from_edge = -((position - static_cast<T>(center)) - half);
    if (!(from_edge >= T(0) && from_edge < length)) return 0;
    const int cell =
        saturate_cast<int>(-(((position - half) - static_cast<T>(center)) / static_cast<T>(resolution_)));
    return std::min(cell, count - 1) + 1;
  }
  /// Truncates; negative values and NaN become huge unsigned numbers, clamped into the ring with the rest.
  template <class Target>
  SLALOM_INLINE static simd::IntPack<Target> clamped_index(const Pack<Target>& cell, int last) {
    using I = typename simd::IntPack<Target>::Vector;
    using U = typename simd::detail::VectorTypes<Target::lanes>::Unsigned;
    const U index = reinterpret_cast<U>(__builtin_convertvector(cell.v, I));
    const U bound = U{} + static_cast<unsigned>(last);
    return simd::IntPack<Target>(reinterpret_cast<I>(index < bound ? index : bound));
  }

  const float* cells_ = nullptr;
  int rows_ = 0;
  int columns_ = 0;
  int stride_log2_ = 0;
  double resolution_ = 1;
  double center_x_ = 0;
  double center_y_ = 0;
  double origin_x_ = 0;  ///< m, origin of the positions
  double origin_y_ = 0;
  GridAxis rows_axis_, columns_axis_;
  int last_row_ = 1, last_column_ = 1;  ///< last cell of the ring; kept to be broadcast from memory
  Coefficient scale_, offset_x_, offset_y_;
};

/// The result of a look-up of a four-layer cell.
template <class T>
struct CellValues {
  T a, b, c, d;  ///< one value for each layer
};

/// The cell at (x, y); m.
template <Scalar T>
CellValues<T> look_up(const GridView<4>& grid, T x, T y) {
  const float* cell = grid.cells() + 4 * grid.index(x, y);
  return {static_cast<T>(cell[0]), static_cast<T>(cell[1]), static_cast<T>(cell[2]), static_cast<T>(cell[3])};
}
/// The value of the cell at a position.
template <Scalar T>
T look_up(const GridView<1>& grid, T x, T y) {
  return static_cast<T>(grid.cells()[grid.index(x, y)]);
}
/// Values of the cells at positions, one for each lane.
template <class Target>
SLALOM_INLINE_CALLS CellValues<Pack<Target>> look_up(const GridView<4>& grid, const Pack<Target>& x,
                                                     const Pack<Target>& y) {
  const auto index = grid.index(x, y);
  CellValues<Pack<Target>> r;
  simd::Operations<Target>::gather_cells(grid.cells(), index.v, r.a.v, r.b.v, r.c.v, r.d.v);
  return r;
}
/// The cells at the positions of a pair of packs.
template <class T>
SLALOM_INLINE_CALLS CellValues<PackPair<T>> look_up(const GridView<4>& grid, const PackPair<T>& x,
                                                    const PackPair<T>& y) {
  const auto low = look_up(grid, x.low, y.low), high = look_up(grid, x.high, y.high);
  return {{low.a, high.a}, {low.b, high.b}, {low.c, high.c}, {low.d, high.d}};
}
/// The cell at a position that is given in cells (`GridView::rows_axis`, `columns_axis`).
template <class Target>
SLALOM_INLINE_CALLS Pack<Target> look_up_cell(const GridView<1>& grid, const Pack<Target>& row,
                                              const Pack<Target>& column) {
  const auto index = grid.index_of_cell(row, column);
  Pack<Target> r;
  simd::Operations<Target>::gather(grid.cells(), index.v, r.v);
  return r;
}
/// Values of the cells at positions, one for each lane.
template <class Target>
SLALOM_INLINE_CALLS Pack<Target> look_up(const GridView<1>& grid, const Pack<Target>& x,
                                         const Pack<Target>& y) {
  const auto index = grid.index(x, y);
  Pack<Target> r;
  simd::Operations<Target>::gather(grid.cells(), index.v, r.v);
  return r;
}
/// The values of the cells at the positions of a pair of packs.
template <class T>
SLALOM_INLINE_CALLS PackPair<T> look_up(const GridView<1>& grid, const PackPair<T>& x, const PackPair<T>& y) {
  return {look_up(grid, x.low, y.low), look_up(grid, x.high, y.high)};
}
/// Looks up positions in cells.
template <class T>
SLALOM_INLINE_CALLS PackPair<T> look_up_cell(const GridView<1>& grid, const PackPair<T>& row,
                                             const PackPair<T>& column) {
  return {look_up_cell(grid, row.low, column.low), look_up_cell(grid, row.high, column.high)};
}

}  // namespace slalom
