#pragma once

#include <cstdint>
#include <vector>

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::tools {

/// The place of a map in an image: `scale` pixels per m, `left` and `top` of the image in m, map frame.
struct MapView {
  double scale = 1;
  double left = 0, top = 0;
  int width = 0, height = 0;  ///< size of the image, pixels

  /// The pixel coordinates of a point of the map frame.
  maps::Point pixel(const maps::Point& point) const {
    return {(point.x - left) * scale, (top - point.y) * scale};
  }
};

/// The cells of a map as pixels 0xAARRGGBB, row by row: free cells white, walls dark, contours smoothed.
std::vector<std::uint32_t> map_pixels(const maps::OccupancyGrid& map, const MapView& view);

/// The part of a map around the points, so that wide empty margins (m) do not make the course small.
maps::OccupancyGrid cropped(const maps::OccupancyGrid& map, const std::vector<maps::Point>& points,
                            double margin);

}  // namespace slalom::tools
