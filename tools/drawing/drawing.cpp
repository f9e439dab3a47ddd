#include "tools/drawing/drawing.hpp"

#include <cairo-svg.h>

#include <cmath>

#include "slalom/core/error.hpp"

namespace slalom::tools {

std::string to_svg(const Drawing& drawing) {
  require_font_files();
  std::string text;
  const auto append = [](void* to, const unsigned char* data, unsigned int size) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
    return CAIRO_STATUS_SUCCESS;
  };
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_svg_surface_create_for_stream(append, &text, drawing.width, drawing.height),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()), cairo_destroy);
  Pen pen(cairo.get());
  pen.fill_surface({1, 1, 1});
  drawing.draw(pen);
  const auto drawn = cairo_status(cairo.get());
  cairo_surface_finish(surface.get());
  const auto status = drawn != CAIRO_STATUS_SUCCESS ? drawn : cairo_surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS) throw IoError("SVG", 0, cairo_status_to_string(status));
  return text;
}

void save_png(const Drawing& drawing, const std::filesystem::path& file, double scale) {
  const Surface surface(static_cast<int>(std::ceil(scale * drawing.width)),
                        static_cast<int>(std::ceil(scale * drawing.height)), scale);
  Pen pen = surface.pen();
  pen.fill_surface({1, 1, 1});
  drawing.draw(pen);
  surface.save(file);
}

}  // namespace slalom::tools
