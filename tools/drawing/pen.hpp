#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/drawing/colour.hpp"

// The names that cairo gives to cairo_t and cairo_surface_t.
struct _cairo;          // NOLINT(bugprone-reserved-identifier)
struct _cairo_surface;  // NOLINT(bugprone-reserved-identifier)

/// Drawing with cairo. Lengths are pixels, y points down.
namespace slalom::tools {

/// The style of a line.
struct Stroke {
  Colour colour;
  double width = 1;
  double dash = 0;  ///< length of dashes and of the gaps between them; 0: solid
  bool round_caps = false;
};

/// Draws on a surface, which must outlive it.
class Pen {
 public:
  using Points = std::vector<std::pair<double, double>>;

  explicit Pen(_cairo* cairo) : cairo_(cairo) {}

  void line(double x0, double y0, double x1, double y1, Colour colour, double width, bool dashed = false);
  /// A line through points, with round corners.
  void path(const Points& points, Colour colour, double width);
  /// A line of any style through points, with round corners; `closed`: back to the first point.
  void stroke(const Points& points, const Stroke& line, bool closed = false);
  // Shapes have a rim only where `rim_width` > 0.
  /// The area that points enclose.
  void area(const Points& points, Colour fill, Colour rim = {}, double rim_width = 0);
  void rectangle(double x, double y, double width, double height, Colour fill);
  /// A rectangle with rounded corners.
  void box(double x, double y, double width, double height, Colour fill, Colour rim = {},
           double rim_width = 0, double radius = 2);
  void disc(double x, double y, double radius, Colour fill, Colour rim = {}, double rim_width = 0);
  void diamond(double x, double y, double radius, Colour fill, Colour rim);
  /// A text that begins at x (`align` 0), is centred there (0.5), or ends there (1).
  void text(double x, double y, double size, const std::string& words, Colour colour, double align = 0,
            bool bold = false);
  /// The width of a text.
  double text_width(const std::string& words, double size, bool bold = false);
  /// An image of pixels 0xAARRGGBB, row by row, `width` in a row, with the upper left corner at the origin.
  void image(const std::vector<std::uint32_t>& pixels, int width);
  /// Copies the picture of another surface, with its upper left corner at the origin.
  void show(_cairo_surface* surface);
  void fill_surface(Colour colour);
  /// Moves the origin of all that is drawn later.
  void shift(double x, double y);
  /// Draws within a rectangle alone, until `unclip`.
  void clip(double x, double y, double width, double height);
  void unclip();

 private:
  void set(Colour colour);
  /// Begins a path through points.
  void trace(const Points& points, bool closed);
  /// Draws a line along the path.
  void outline(const Stroke& line);
  /// Fills the path, draws its rim, and ends it.
  void paint(Colour fill, Colour rim, double rim_width);
  void set_font(double size, bool bold);

  _cairo* cairo_;
};

}  // namespace slalom::tools
