#include "tools/drawing/map_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/drawing/colour.hpp"

namespace slalom::tools {
namespace {

constexpr Colour ground{0.925, 0.935, 0.95, 1};  // beyond the walls
constexpr Colour road{1, 1, 1, 1};
constexpr Colour wall{0.20, 0.24, 0.32, 1};

std::uint32_t argb(Colour c) {
  const auto byte = [](double v) {
    return static_cast<std::uint32_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
  };
  return 0xFF000000u | byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

/// A value per cell, read between the cells' centres.
struct Field {
  int width = 0, height = 0;
  std::vector<float> values;

  double cell(int column, int row) const {
    if (column < 0 || row < 0 || column >= width || row >= height) return 0;
    return values[static_cast<std::size_t>(row) * width + column];
  }
  double at(double column, double row) const {
    const double left = std::floor(column), low = std::floor(row), s = column - left, t = row - low;
    const int i = static_cast<int>(left), j = static_cast<int>(low);
    return (1 - t) * ((1 - s) * cell(i, j) + s * cell(i + 1, j)) +
           t * ((1 - s) * cell(i, j + 1) + s * cell(i + 1, j + 1));
  }
};

/// 1 on the cells of one kind, 0 elsewhere, blurred a little: its contours lack the cells' steps.
Field smoothed_cells(const maps::OccupancyGrid& map, maps::Occupancy kind) {
  static constexpr std::array<double, 3> weights = {0.40, 0.24, 0.06};  // a Gaussian of about one cell
  Field field{map.width, map.height, {}}, across = field;
  for (const auto cell : map.cells) field.values.push_back(cell == kind ? 1.0f : 0.0f);
  const auto blur = [&](const Field& from, int dx, int dy) {
    std::vector<float> values(from.values.size());
    for (int row = 0; row < map.height; ++row)
      for (int column = 0; column < map.width; ++column) {
        double sum = weights[0] * from.cell(column, row);
        for (int k = 1; k <= 2; ++k)
          sum += weights[k] *
                 (from.cell(column + k * dx, row + k * dy) + from.cell(column - k * dx, row - k * dy));
        values[static_cast<std::size_t>(row) * map.width + column] = static_cast<float>(sum);
      }
    return values;
  };
  across.values = blur(field, 1, 0);
  field.values = blur(across, 0, 1);
  return field;
}

/// The depth of a pixel inside a contour at `level`, 0..1, over about one pixel; `cell` is a cell's size in
/// pixels.
double edge(double value, double level, double cell) {
  return std::clamp(0.5 + (value - level) * 2.5 * std::max(cell, 1.0), 0.0, 1.0);
}

}  // namespace

std::vector<std::uint32_t> map_pixels(const maps::OccupancyGrid& map, const MapView& view) {
  const Field walls = smoothed_cells(map, maps::Occupancy::occupied),
              roads = smoothed_cells(map, maps::Occupancy::free);
  std::vector<std::uint32_t> pixels;
  pixels.reserve(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const double cell = view.scale * map.resolution;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const maps::Point at = maps::inverse_transform(
          map.origin, {view.left + (x + 0.5) / view.scale, view.top - (y + 0.5) / view.scale});
      const double column = at.x / map.resolution - 0.5, row = at.y / map.resolution - 0.5;
      const Colour below = mixed(ground, road, edge(roads.at(column, row), 0.5, cell));
      pixels.push_back(argb(mixed(below, wall, edge(walls.at(column, row), 0.35, cell))));
    }
  }
  return pixels;
}

maps::OccupancyGrid cropped(const maps::OccupancyGrid& map, const std::vector<maps::Point>& points,
                            double margin) {
  double low_x = 1e300, low_y = 1e300, high_x = -1e300, high_y = -1e300;
  for (const maps::Point& point : points) {
    const maps::Point at = maps::inverse_transform(map.origin, point);
    low_x = std::min(low_x, at.x);
    low_y = std::min(low_y, at.y);
    high_x = std::max(high_x, at.x);
    high_y = std::max(high_y, at.y);
  }
  const auto cell = [&](double metres, int count) {
    return std::clamp(static_cast<int>(std::floor(metres / map.resolution)), 0, count);
  };
  const int left = cell(low_x - margin, map.width), right = cell(high_x + margin, map.width);
  const int low = cell(low_y - margin, map.height), high = cell(high_y + margin, map.height);
  if (right <= left || high <= low) return map;
  maps::OccupancyGrid part;
  part.width = right - left;
  part.height = high - low;
  part.resolution = map.resolution;
  const maps::Point corner = maps::transform(map.origin, {left * map.resolution, low * map.resolution});
  part.origin = {corner.x, corner.y, map.origin.yaw};
  for (int row = low; row < high; ++row)
    for (int column = left; column < right; ++column) part.cells.push_back(map.at(column, row));
  return part;
}

}  // namespace slalom::tools
