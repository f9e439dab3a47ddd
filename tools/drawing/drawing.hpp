#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The names that cairo gives to cairo_t and cairo_surface_t.
struct _cairo;          // NOLINT(bugprone-reserved-identifier)
struct _cairo_surface;  // NOLINT(bugprone-reserved-identifier)

/// Drawing with cairo. Lengths are pixels, y points down.
namespace slalom::tools {

/// A colour, each part in [0, 1].
struct Colour {
  double red = 0, green = 0, blue = 0, opacity = 1;
};

inline constexpr Colour ink{0.13, 0.16, 0.22};        ///< colour of text and lines
inline constexpr Colour faint_ink{0.42, 0.46, 0.54};  ///< colour of remarks
inline constexpr Colour rule{0.89, 0.91, 0.94};       ///< colour of the lines of a grid
inline constexpr Colour white{1, 1, 1};

/// The colour 0xRRGGBB.
constexpr Colour hex(unsigned rgb, double opacity = 1) {
  return {(rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, opacity};
}

// Colours by meaning, which are those of the page in its light theme (view/page/src/scene/palette.ts).
inline constexpr Colour plan_colour = hex(0x007a3d), guide_colour = hex(0xa01bb0), hit_colour = hex(0xc93410),
                        nominal_colour = hex(0x20262e, 0.7), driven_colour = hex(0x6b7787, 0.9),
                        path_colour = hex(0x6b7a8d, 0.6), obstacle_colour = hex(0xd98518),
                        obstacle_rim = hex(0x5c3500), opponent_colour = hex(0x1273b8);
/// Colours of a quantity, such as a cost, from low to high, for any kind of colour vision and in grey.
inline constexpr Colour quantity_stops[] = {hex(0x003d79), hex(0x36577c), hex(0x646f7b),
                                            hex(0x8c8777), hex(0xb2a16e), hex(0xdabb5c)};

/// The colour of a method in every picture, by its name, which may be followed by more words. Other names
/// have a colour of their own, too, but may share it.
Colour method_colour(std::string_view name);

/// `a` at share 0, `b` at share 1, linear between them.
Colour mixed(Colour a, Colour b, double share);

/// The colour of a value in [0, 1] on a scale through `stops` at equal distances.
Colour scale_colour(std::span<const Colour> stops, double value);

/// The colour of a sample by its cost in [0, 1].
inline Colour cost_colour(double cost, double opacity) {
  Colour colour = scale_colour(quantity_stops, cost);
  colour.opacity = opacity;
  return colour;
}

/// The colour of a value in [0, 1] on the scale of quantities, from slow (yellow) to fast (blue).
inline Colour speed_colour(double value) {
  return scale_colour(quantity_stops, 1 - value);
}

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

/// A drawing that looks the same in every format.
struct Drawing {
  double width = 0, height = 0;  ///< units of length of the pen
  std::function<void(Pen&)> draw;
};

/// A drawing that is made step by step.
class Canvas {
 public:
  Canvas(double width, double height);

  Pen& pen() { return pen_; }
  /// The drawing so far. It refers to the canvas.
  Drawing drawing() const;

 private:
  double width_, height_;
  std::unique_ptr<_cairo_surface, void (*)(_cairo_surface*)> surface_;
  std::unique_ptr<_cairo, void (*)(_cairo*)> cairo_;
  Pen pen_;
};

/// The drawing as an SVG document. Throws IoError if not everything could be drawn.
std::string to_svg(const Drawing& drawing);

/// The drawing as pixels 0xXXRRGGBB, row by row, one for a unit of length. Throws IoError as `to_svg` does.
std::string to_pixels(const Drawing& drawing);

/// Writes the drawing as SVG or PDF if the name of the file ends so, otherwise as PNG with `scale` pixels for
/// a unit of length. Throws IoError.
void save(const Drawing& drawing, const std::filesystem::path& file, double scale = 2);

}  // namespace slalom::tools
