#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "tools/drawing/pen.hpp"

namespace slalom::tools {

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
