#pragma once

#include "slalom/core/derivatives/dual_math.hpp"
#include "slalom/core/grid_view.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/maps/cell_grid.hpp"
#include "slalom/maps/occupancy_grid.hpp"

namespace slalom::maps {

/// The place of the samples of a field: the centres of square cells, placed like those of an OccupancyGrid.
struct FieldGeometry {
  int width = 1;          ///< cells along the grid's x
  int height = 1;         ///< cells along the grid's y
  double resolution = 1;  ///< m per cell
  Pose origin{};          ///< pose of the lower left corner of cell (0, 0), map frame

  /// The centre of a cell, map frame, m.
  Point center(int column, int row) const {
    return transform(origin, {(column + 0.5) * resolution, (row + 0.5) * resolution});
  }
};

/// A field's value at a position, and its gradient.
template <class T>
struct FieldValue {
  T value;   ///< value in the unit of the samples
  T dx, dy;  ///< partial derivatives by x and y of the map frame, in that unit per metre
};

/// A map that a problem looks up: a distance, a height, a cost. Its samples are interpolated bilinearly, so
/// the value is continuous everywhere; its gradient is exact, and jumps on the lines that join samples.
/// Beyond the outermost samples the value is that of the nearest point of their edge.
///
///     struct Robot {
///       slalom::maps::Field walls;  // made by signed_distance(load_ros_map(...))
///       ...
///       const T distance = walls.value(x.x, x.y);                  // in a cost; T is double or a pack
///
/// All coefficients of a cell lie in 16 bytes, so a look-up of value and gradient is one load for each lane.
/// Copies share the samples, which never change: to change a map, assign another field between two solves.
/// Positions in lanes are float32: for a map that is further than some kilometres from the origin of its
/// frame, use `relative_to` and states relative to the same point.
class Field {
 public:
  /// 0 everywhere.
  Field();

  /// From samples [height][width], row 0 at the smallest y of the grid. Throws std::invalid_argument unless
  /// there are width x height finite float32 values, at most 2^26, and the geometry is finite with a
  /// resolution above 0.
  Field(const FieldGeometry& geometry, std::span<const double> samples);

  /// From a function of x and y in the map frame, m, which is called for the centre of each cell. Throws as
  /// the constructor does.
  template <class Function>
  static Field from_function(const FieldGeometry& geometry, Function&& function) {
    check(geometry);
    std::vector<double> samples;
    samples.reserve(static_cast<std::size_t>(geometry.width) * static_cast<std::size_t>(geometry.height));
    for (int row = 0; row < geometry.height; ++row) {
      for (int column = 0; column < geometry.width; ++column) {
        const Point center = geometry.center(column, row);
        samples.push_back(static_cast<double>(function(center.x, center.y)));
      }
    }
    return Field(geometry, samples);
  }

  /// The value at a position of the map frame, m.
  template <class T>
  SLALOM_INLINE_CALLS T value(const T& x, const T& y) const {
    return value_and_gradient(x, y).value;
  }

  /// The value at a position of the map frame (m), and its gradient. On a line between two cells the gradient
  /// is that of the cell with the larger coordinates; outside the samples it is 0 across their edge.
  template <class T>
  SLALOM_INLINE_CALLS FieldValue<T> value_and_gradient(const T& x, const T& y) const {
    const T column = x * T(column_.by_x) + y * T(column_.by_y) + T(column_.offset);
    const T row = x * T(row_.by_x) + y * T(row_.by_y) + T(row_.offset);
    const CellValues<T> c = cell(row, column);
    const T s = column - floor(column), t = row - floor(row);
    const T by_column = c.b + c.d * t, by_row = c.c + c.d * s;
    return {c.a + c.b * s + by_row * t, by_column * T(column_.by_x) + by_row * T(row_.by_x),
            by_column * T(column_.by_y) + by_row * T(row_.by_y)};
  }

  /// Values and, unless `dx` and `dy` are null, gradients at `count` positions, at the full width of the
  /// processor. `dx` and `dy` must be both null or both not.
  void evaluate(const float* x, const float* y, std::size_t count, float* value, float* dx = nullptr,
                float* dy = nullptr) const;

  /// Returns the same field for look-ups at positions relative to the point (x, y) of the map frame, m, along
  /// the axes of that frame.
  Field relative_to(double x, double y) const;

  /// Position and number of the samples, map frame.
  const FieldGeometry& geometry() const noexcept { return geometry_; }

 private:
  /// Position in cells along one axis of the grid, 1 at its first sample: by_x x + by_y y + offset.
  struct Axis {
    Coefficient by_x, by_y, offset;
  };

  static void check(const FieldGeometry& geometry);
  void place(double x, double y);

  template <Scalar T>
  CellValues<T> cell(T row, T column) const {
    const auto index = [](T position, int last) {
      return position > T(0) ? saturate_cast<int>(std::min(position, static_cast<T>(last))) : 0;
    };
    const float* c = cells_->at(index(row, geometry_.height) - 1, index(column, geometry_.width) - 1);
    return {static_cast<T>(c[0]), static_cast<T>(c[1]), static_cast<T>(c[2]), static_cast<T>(c[3])};
  }
  template <class T, int N>
  CellValues<Dual<T, N>> cell(const Dual<T, N>& row, const Dual<T, N>& column) const {
    const CellValues<double> c = cell(slalom::detail::plain(row), slalom::detail::plain(column));
    return {c.a, c.b, c.c, c.d};
  }
  template <class Target>
  SLALOM_INLINE_CALLS CellValues<Pack<Target>> cell(const Pack<Target>& row,
                                                    const Pack<Target>& column) const {
    using F = Pack<Target>;  // the view takes what lies below its ring to the ring's far side
    const auto index = view_.index_of_cell(max(row, F(0.0f)), max(column, F(0.0f)));
    CellValues<Pack<Target>> c;
    simd::Operations<Target>::gather_cells(view_.cells(), index.v, c.a.v, c.b.v, c.c.v, c.d.v);
    return c;
  }

  FieldGeometry geometry_;
  Axis row_, column_;
  GridView<4> view_;
  /// The cells between neighbouring samples: {a, b, c, d} of a + b s + c t + d s t, where s and t run from 0
  /// to 1 along x and y of the grid. The ring around them continues the values of the edge.
  std::shared_ptr<const CellGrid<4>> cells_;
};

/// Options of signed_distance.
struct SignedDistanceOptions {
  bool unknown_is_obstacle = true;  ///< unknown cells count as occupied
  bool outside_is_obstacle = true;  ///< so does all that lies outside the grid
};

/// The distance from every position to the nearest edge of an obstacle, m: above 0 in free space, below 0 in
/// obstacles. In the centres of cells it is half a cell less than the distance to the centre of the nearest
/// obstacle cell. That is the distance to the edge of that cell, or up to 0.21 cells more where its nearest
/// point is a corner. Without any obstacle the value is the diagonal of the grid. Throws
/// std::invalid_argument unless the grid has width x height cells, at least one and with a border at most
/// 2^26, a finite origin and a resolution above 0.
Field signed_distance(const OccupancyGrid& grid, const SignedDistanceOptions& options = {});

}  // namespace slalom::maps
