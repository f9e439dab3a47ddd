#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tools/drawing/canvas.hpp"

/// Drawings that are the same as SVG and as PNG. Lengths are pixels, y down.
namespace slalom::tools {

/// What a drawing is drawn with.
class Pen {
 public:
  explicit Pen(cairo_t* cairo) : cairo_(cairo) {}

  void line(double x0, double y0, double x1, double y1, Colour colour, double width, bool dashed = false);
  /// A rectangle with rounded corners; a rim only where `rim_width` > 0.
  void box(double x, double y, double width, double height, Colour fill, Colour rim = {},
           double rim_width = 0, double radius = 2);
  /// A line through points, with round corners.
  using Points = std::vector<std::pair<double, double>>;
  void path(const Points& points, Colour colour, double width);
  /// What points enclose.
  void area(const Points& points, Colour fill);
  /// Draws within a rectangle alone, until `unclip`.
  void clip(double x, double y, double width, double height);
  void unclip();
  void disc(double x, double y, double radius, Colour fill);
  void diamond(double x, double y, double radius, Colour fill, Colour rim);
  /// `align`: 0 begins at x, 0.5 is centred, 1 ends there.
  void text(double x, double y, double size, const std::string& words, Colour colour, double align = 0,
            bool bold = false);

 private:
  void set(Colour colour);
  cairo_t* cairo_;
};

struct Drawing {
  double width = 0, height = 0;
  std::function<void(Pen&)> draw;
};

/// The drawing as an SVG document. Throws IoError.
std::string to_svg(const Drawing& drawing);
/// Writes it with `scale` pixels for one. Throws IoError.
void save_png(const Drawing& drawing, const std::filesystem::path& file, double scale = 2);

}  // namespace slalom::tools
