#include <algorithm>
#include <array>
#include <limits>

#include "controller.hpp"
#include "slalom/maps/field.hpp"
#include "slalom/maps/ros_map.hpp"

namespace slalom::python {
namespace {

using maps::Field;
using maps::FieldGeometry;
using maps::Occupancy;
using maps::OccupancyGrid;

constexpr const char* lower_left_corner = "x, y (m), yaw (rad) of the lower left corner";

/// The argument `origin`, by default the origin of the map frame.
py::arg_v level() {
  return {"origin", std::vector<double>{0, 0, 0}, "..."};
}

/// x, y and, if given, yaw.
maps::Pose to_pose(const std::vector<double>& origin) {
  if (origin.size() != 2 && origin.size() != 3)
    throw py::value_error("origin: has " + std::to_string(origin.size()) +
                          " values, must have 2 or 3: x (m), y (m) and, if any, yaw (rad)");
  return {origin[0], origin[1], origin.size() == 3 ? origin[2] : 0};
}

int extent(py::ssize_t count, const char* what) {
  if (count > std::numeric_limits<int>::max())
    throw py::value_error(std::string(what) + ": must be at most 2^31 - 1");
  return static_cast<int>(count);
}

Field make_field(const Numbers& samples, double resolution, const std::vector<double>& origin) {
  if (samples.ndim() != 2)
    throw py::value_error("Field.samples: has " + std::to_string(samples.ndim()) +
                          " dimensions, must have 2: [row, column]");
  const int height = extent(samples.shape(0), "rows"), width = extent(samples.shape(1), "columns");
  return Field({width, height, resolution, to_pose(origin)},
               std::span(samples.data(), static_cast<std::size_t>(samples.size())));
}

Field field_from_function(const py::object& function, int width, int height, double resolution,
                          const std::vector<double>& origin) {
  const FieldGeometry geometry{width, height, resolution, to_pose(origin)};
  static_cast<void>(Field(FieldGeometry{1, 1, resolution, geometry.origin}, std::array{0.0}));
  if (width < 1 || height < 1 || std::int64_t{width} * height > std::int64_t{1} << 26)
    throw py::value_error("Field.from_function: " + std::to_string(width) + " x " + std::to_string(height) +
                          " cells must be at least 1 x 1 and at most 2^26");
  py::array_t<double> x({height, width}), y({height, width});
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const maps::Point center = geometry.center(column, row);
      x.mutable_at(row, column) = center.x;
      y.mutable_at(row, column) = center.y;
    }
  }
  const Numbers samples(function(x, y));
  if (samples.ndim() != 2 || samples.shape(0) != height || samples.shape(1) != width)
    throw py::value_error("Field.from_function: the function must return an array of shape (" +
                          std::to_string(height) + ", " + std::to_string(width) + "), as its arguments have");
  return make_field(samples, resolution, origin);
}

/// An array, or a number if the array has no dimensions.
template <class Array>
py::object result(Array&& array) {
  return array.ndim() == 0 ? py::object(array[py::tuple()]) : py::object(array);
}

template <class Real>
py::object look_up(const Field& field, const py::array& x, const py::array& y, bool gradient) {
  using Array = py::array_t<Real, py::array::c_style | py::array::forcecast>;
  const Array xs(x), ys(y);
  const std::vector<py::ssize_t> shape(xs.shape(), xs.shape() + xs.ndim());
  if (!std::ranges::equal(shape, extents_of(ys))) throw py::value_error("x, y: must have the same shape");
  const auto count = static_cast<std::size_t>(xs.size());
  const std::vector<py::ssize_t> shape_of_gradient = gradient ? shape : std::vector<py::ssize_t>{0};
  Array values(shape), dx(shape_of_gradient), dy(shape_of_gradient);
  Real *const value = values.mutable_data(), *const to_dx = gradient ? dx.mutable_data() : nullptr,
              *const to_dy = gradient ? dy.mutable_data() : nullptr;
  if constexpr (std::is_same_v<Real, float>) {
    field.evaluate(xs.data(), ys.data(), count, value, to_dx, to_dy);
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = field.value_and_gradient(xs.data()[i], ys.data()[i]);
      value[i] = at.value;
      if (gradient) to_dx[i] = at.dx, to_dy[i] = at.dy;
    }
  }
  if (!gradient) return result(values);
  return py::make_tuple(result(values), result(dx), result(dy));
}

/// The value at positions, and with `gradient` its derivatives, in float32 if both arrays are.
template <bool gradient>
py::object look_up(const Field& field, const py::object& x_values, const py::object& y_values) {
  const py::array x(x_values), y(y_values);
  const bool single = py::isinstance<py::array_t<float>>(x) && py::isinstance<py::array_t<float>>(y);
  return single ? look_up<float>(field, x, y, gradient) : look_up<double>(field, x, y, gradient);
}

OccupancyGrid make_grid(const py::object& given, double resolution, const std::vector<double>& origin) {
  const py::array cells(given);
  const bool flags = py::isinstance<py::array_t<bool>>(cells);
  const py::array_t<int, py::array::c_style | py::array::forcecast> values(cells);
  if (values.ndim() != 2)
    throw py::value_error("OccupancyGrid.cells: has " + std::to_string(values.ndim()) +
                          " dimensions, must have 2: [row, column]");
  OccupancyGrid grid{
      extent(values.shape(1), "columns"), extent(values.shape(0), "rows"), resolution, to_pose(origin), {}};
  grid.cells.reserve(static_cast<std::size_t>(values.size()));
  for (py::ssize_t i = 0; i < values.size(); ++i) {
    const int cell = values.data()[i];
    if (cell < -1 || cell > 100)
      throw py::value_error("OccupancyGrid.cells: " + std::to_string(cell) +
                            " must be in [-1, 100], or the array one of truth values");
    grid.cells.push_back(flags         ? (cell ? Occupancy::occupied : Occupancy::free)
                         : cell == 0   ? Occupancy::free
                         : cell == 100 ? Occupancy::occupied
                                       : Occupancy::unknown);
  }
  return grid;
}

py::array_t<std::int8_t> cells_of(const OccupancyGrid& grid) {
  py::array_t<std::int8_t> cells({grid.height, grid.width});
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const Occupancy cell = grid.cells[i];
    cells.mutable_data()[i] = cell == Occupancy::free ? 0 : cell == Occupancy::occupied ? 100 : -1;
  }
  return cells;
}

void bind_field(py::module_& module) {
  constexpr const char* words =
      "A map that a problem looks up: a distance, a height, a cost. Its samples are interpolated bilinearly; "
      "beyond the outermost ones the value is that of the nearest point of their edge.";
  py::class_<Field> field(module, "Field", words, guarded());
  field.def(py::init(&make_field), "samples"_a, "resolution"_a, level())
      .def_static("from_function", &field_from_function, "function"_a, "width"_a, "height"_a, "resolution"_a,
                  level(), "The field of a function.")
      .def("value", &look_up<false>, "x"_a, "y"_a, "The value at positions.")
      .def("value_and_gradient", &look_up<true>, "x"_a, "y"_a,
           "The value at positions, and its derivatives by x and y.")
      .def("relative_to", &Field::relative_to, "x"_a, "y"_a,
           "The same field for positions relative to a point.");
  const auto read = reader(field);
  read("shape", "rows and columns of samples",
       [](const Field& f) { return py::make_tuple(f.geometry().height, f.geometry().width); });
  read("resolution", "m per cell", [](const Field& f) { return f.geometry().resolution; });
  read("origin", lower_left_corner, [](const Field& f) { return to_tuple(f.geometry().origin); });
}

}  // namespace

void bind_maps(py::module_& module) {
  py::class_<OccupancyGrid> bound(module, "OccupancyGrid", "A map of free, occupied and unknown cells.",
                                  guarded());
  bound.def(py::init(&make_grid), "cells"_a, "resolution"_a, level());
  const auto read = reader(bound);
  read("cells", "int8 [row, column], a copy: 0 free, 100 occupied, -1 unknown", &cells_of);
  read("resolution", "m per cell", [](const OccupancyGrid& g) { return g.resolution; });
  read("origin", lower_left_corner, [](const OccupancyGrid& g) { return to_tuple(g.origin); });
  bind_field(module);
  module.def(
      "load_ros_map",
      [](const std::string& file) {
        std::vector<std::string> notes;
        OccupancyGrid grid = [&] {
          const py::gil_scoped_release others_run;
          return maps::load_ros_map(file, maps::MapRule::map_server, &notes);
        }();
        for (const std::string& note : notes)
          if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), 1) != 0) throw py::error_already_set();
        return grid;
      },
      "file"_a, "Loads a map of ROS map_server from its yaml file.");
  module.def(
      "signed_distance",
      [](const OccupancyGrid& grid, bool unknown_is_obstacle, bool outside_is_obstacle) {
        return maps::signed_distance(grid, {unknown_is_obstacle, outside_is_obstacle});
      },
      "grid"_a, "unknown_is_obstacle"_a = true, "outside_is_obstacle"_a = true,
      py::call_guard<py::gil_scoped_release>(), "The distance to the nearest edge of an obstacle.");
}

}  // namespace slalom::python
