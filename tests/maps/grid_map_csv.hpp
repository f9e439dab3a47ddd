#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "maps/csv_table.hpp"
#include "slalom/maps/cell_grid.hpp"

namespace slalom::testing {

/// A map of golden data: its cells, with the ring for "outside", and where they lie.
template <int Layers>
struct GridMap {
  maps::GridGeometry geometry;
  maps::CellGrid<Layers> cells;

  GridView<Layers> view() const { return cells.view(geometry); }
};

/// Reads one CSV file per layer, row i = index_x, column j = index_y; values are rounded to float32. Layers
/// for which there is no file hold 0. `outside` are the values of the ring.
template <int Layers>
GridMap<Layers> load_grid_map(const std::vector<std::filesystem::path>& layer_files, double resolution,
                              double center_x, double center_y, const float (&outside)[Layers]) {
  const auto first = read_csv_numbers(layer_files.at(0), false);
  const int rows = static_cast<int>(first.size()), columns = static_cast<int>(first.at(0).size());
  GridMap<Layers> map{{rows, columns, resolution, center_x, center_y}, maps::CellGrid<Layers>(rows, columns)};
  map.cells.fill(outside);
  for (std::size_t layer = 0; layer < Layers; ++layer) {
    const auto values = layer == 0 ? first
                        : layer < layer_files.size()
                            ? read_csv_numbers(layer_files[layer], false)
                            : std::vector(first.size(), std::vector<double>(first[0].size()));
    if (values.size() != first.size())
      throw std::runtime_error(layer_files[layer].string() + ": wrong number of rows");
    for (int row = 0; row < rows; ++row) {
      const auto& line = values[static_cast<std::size_t>(row)];
      if (line.size() != first[0].size())
        throw std::runtime_error(layer_files[layer].string() + ": wrong number of columns");
      for (int column = 0; column < columns; ++column) {
        map.cells.at(row, column)[layer] = static_cast<float>(line[static_cast<std::size_t>(column)]);
      }
    }
  }
  return map;
}

/// The obstacle map `<id>_obstacle.csv` of golden data, in the robot's frame: 10 x 10 m, centre (3, 0);
/// outside 100.
inline GridMap<1> load_obstacle_map(const std::filesystem::path& folder, const std::string& id,
                                    double resolution = 0.05, double center_x = 3, double center_y = 0,
                                    float outside = 100) {
  return load_grid_map<1>({folder / (id + "_obstacle.csv")}, resolution, center_x, center_y, {outside});
}

/// The reference map {distance, yaw, speed, 0} of golden data, centred on the robot; outside: distance 20,
/// yaw 2, speed 0.
inline GridMap<4> load_reference_map(const std::filesystem::path& folder, const std::string& id,
                                     double robot_x, double robot_y, double resolution = 0.1) {
  return load_grid_map<4>(
      {folder / (id + "_distance.csv"), folder / (id + "_angle.csv"), folder / (id + "_speed.csv")},
      resolution, robot_x, robot_y, {20, 2, 0, 1});
}

}  // namespace slalom::testing
