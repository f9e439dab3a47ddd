#pragma once

#include <cairo.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "slalom/maps/occupancy_grid.hpp"
#include "slalom/maps/pose.hpp"

namespace slalom::tools {

/// A colour, each part in [0, 1].
struct Colour {
  double red = 0, green = 0, blue = 0, opacity = 1;
};

/// The colour of a value in [0, 1] on a scale from slow (blue) over green to fast (red), even in lightness
/// enough to be read on white.
Colour speed_colour(double value);

/// A picture of a place seen from above, with a band for title, scale bar and speed scale below it. Lengths
/// are metres of the map frame unless they are called pixels.
class Canvas {
 public:
  /// Shows the cells of `map` that are known, `long_side` pixels along the longer side of the map.
  Canvas(const maps::OccupancyGrid& map, int long_side = 1200);

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

  /// An arrow head of `size` pixels at a pose.
  void arrow(const maps::Pose& at, double size, Colour fill);

  /// The band below the picture: a title, a line of facts, a scale bar, and the scale of speeds.
  void legend(const std::string& title, const std::string& facts, double slowest, double fastest);

  /// The band below the picture: a title, a line of facts, a scale bar, and what colours mean.
  void key(const std::string& title, const std::string& facts,
           const std::vector<std::pair<std::string, Colour>>& entries);

  /// Writes a PNG. Throws IoError.
  void save(const std::filesystem::path& file) const;

 private:
  maps::Point pixel(const maps::Point& point) const;
  void set(Colour colour);
  void scale_bar(double longest, double right, double at);
  void draw_cells(const maps::OccupancyGrid& map);
  void text(double x, double y, double size, const std::string& words, Colour colour, bool bold,
            double align);
  /// The size, between `least` and `size`, at which bold words are at most `width` pixels wide.
  double fitting_size(const std::string& words, double size, double least, double width);
  /// Breaks a line of facts at its middle dots, so that none is wider than `width` pixels.
  std::vector<std::string> wrapped(const std::string& words, double size, double width);

  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_{nullptr, cairo_surface_destroy};
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo_{nullptr, cairo_destroy};
  double scale_ = 1;                           ///< pixels per m
  double left_ = 0, top_ = 0;                  ///< m, the map's upper left corner
  int width_ = 0, map_height_ = 0, band_ = 0;  ///< pixels
};

/// The part of a map round the points, so that wide empty margins (m) do not make the course small.
maps::OccupancyGrid cropped(const maps::OccupancyGrid& map, const std::vector<maps::Point>& points,
                            double margin);

}  // namespace slalom::tools
