#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "slalom/maps/cell_grid.hpp"

namespace slalom::testing {

/// The numbers of a comma-separated file, row by row; "nan" and "inf" are read too.
inline std::vector<std::vector<double>> read_csv_numbers(const std::filesystem::path& path,
                                                         bool skip_header) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be read");
  std::vector<std::vector<double>> rows;
  std::string line;
  if (skip_header) std::getline(stream, line);
  while (std::getline(stream, line)) {
    auto& row = rows.emplace_back();
    for (const char* text = line.c_str(); *text;) {
      char* end = nullptr;
      row.push_back(std::strtod(text, &end));
      if (end == text) throw std::runtime_error(path.string() + ": no number: " + line);
      text = *end == ',' ? end + 1 : end;
      while (*text == '\r' || *text == ' ') ++text;
    }
  }
  return rows;
}

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
  std::vector<std::vector<std::vector<double>>> layers;
  for (const auto& file : layer_files) layers.push_back(read_csv_numbers(file, false));
  const int rows = static_cast<int>(layers[0].size()), columns = static_cast<int>(layers[0].at(0).size());
  GridMap<Layers> map{{rows, columns, resolution, center_x, center_y}, maps::CellGrid<Layers>(rows, columns)};
  map.cells.fill(outside);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (std::size_t layer = 0; layer < Layers; ++layer)
        map.cells.at(row, column)[layer] =
            layer < layers.size() ? static_cast<float>(layers[layer].at(row).at(column)) : 0.0f;
  return map;
}

/// The obstacle map `<id>_obstacle.csv` of golden data, robot's frame: 10 x 10 m, centre (3, 0); outside -1.
inline GridMap<1> load_obstacle_map(const std::filesystem::path& folder, const std::string& id) {
  return load_grid_map<1>({folder / (id + "_obstacle.csv")}, 0.05, 3, 0, {-1});
}

/// The reference map {distance, yaw, speed, 0} of golden data, centred on the robot; outside: distance 20,
/// yaw 2, speed 0.
inline GridMap<4> load_reference_map(const std::filesystem::path& folder, const std::string& id,
                                     double robot_x, double robot_y) {
  return load_grid_map<4>(
      {folder / (id + "_distance.csv"), folder / (id + "_angle.csv"), folder / (id + "_speed.csv")}, 0.1,
      robot_x, robot_y, {20, 2, 0, 1});
}

}  // namespace slalom::testing
