#pragma once

#include <algorithm>

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"
#include "tools/drawing/drawing.hpp"

namespace slalom::tools {

/// A rectangle of the map frame that grows, m.
struct Bounds {
  double left = 1e300, right = -1e300, low = 1e300, top = -1e300;

  /// Grows to include a point with some room beside it and above and below it.
  void include(const maps::Point& point, double across, double up) {
    left = std::min(left, point.x - across);
    right = std::max(right, point.x + across);
    low = std::min(low, point.y - up);
    top = std::max(top, point.y + up);
  }
  void include(const maps::Point& point, double margin = 0) { include(point, margin, margin); }
};

/// The place of a picture in the map frame: `scale` pixels per m, `left` and `top` in m.
struct MapView {
  double scale = 1;
  double left = 0, top = 0;
  int width = 0, height = 0;  ///< size of the picture, pixels

  /// The pixel coordinates of a point of the map frame.
  maps::Point pixel(const maps::Point& point) const {
    return {(point.x - left) * scale, (top - point.y) * scale};
  }
};

/// The part of a map that a view shows, as pixels 0xFFRRGGBB, row by row: free cells white, walls dark,
/// contours smoothed.
std::vector<std::uint32_t> map_pixels(const maps::OccupancyGrid& map, const MapView& view);

/// A picture of a place seen from above, with a band for title, scale bar and speed scale below it. Lengths
/// are metres of the map frame unless they are called pixels.
class MapPicture {
 public:
  /// Shows the map, or the part of it within `margin` (m) around the points if there are any, `long_side`
  /// pixels along its longer side: free cells white, walls dark.
  explicit MapPicture(const maps::OccupancyGrid& map, int long_side = 1200,
                      const std::vector<maps::Point>& points = {}, double margin = 0);

  /// A line through points, `width` pixels.
  void line(const std::vector<maps::Point>& points, Colour colour, double width, bool closed,
            bool dashed = false);

  /// A line coloured by the speeds (m/s) at its points, between `slowest` and `fastest`.
  void speed_line(const std::vector<maps::Point>& points, const std::vector<double>& speeds, double slowest,
                  double fastest, double width, bool closed);

  /// A filled polygon with a rim.
  void polygon(const std::vector<maps::Point>& corners, Colour fill, Colour rim);

  /// A disc of `radius` pixels with a white rim.
  void disc(const maps::Point& centre, double radius, Colour fill);

  /// A cross with a white rim whose arms are `size` pixels long.
  void cross(const maps::Point& centre, double size, Colour colour);

  /// An arrow head of `size` pixels at a pose.
  void arrow(const maps::Pose& at, double size, Colour fill);

  /// The band below the picture: a title, a line of facts, a scale bar, and the scale of speeds.
  void legend(const std::string& title, const std::string& facts, double slowest, double fastest);

  /// The band below the picture: a title, a line of facts, a scale bar, and what the colours mean.
  void key(const std::string& title, const std::string& facts,
           const std::vector<std::pair<std::string, Colour>>& entries);

  /// Writes the picture as PNG, SVG or PDF, by the ending of the file. Throws IoError.
  void save(const std::filesystem::path& file) const { tools::save(canvas_.drawing(), file, 1); }

 private:
  Pen::Points pixels(const std::vector<maps::Point>& points) const;
  void scale_bar(double longest, double right, double at);
  /// The size, between `least` and `size`, at which bold words are at most `width` pixels wide.
  double fitting_size(const std::string& words, double size, double least, double width);
  /// Breaks a line of facts at its middle dots, so that no line is wider than `width` pixels.
  std::vector<std::string> wrapped(const std::string& words, double size, double width);

  MapView view_;
  Canvas canvas_;
  Pen& pen_ = canvas_.pen();
};

}  // namespace slalom::tools
