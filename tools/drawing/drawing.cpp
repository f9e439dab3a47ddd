#include "tools/drawing/drawing.hpp"

#include <cairo-svg.h>

#include <cmath>

#include "slalom/core/error.hpp"

namespace slalom::tools {
namespace {

struct Surface {
  explicit Surface(cairo_surface_t* made) : surface(made), cairo(cairo_create(made)) {}
  ~Surface() {
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
  }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;
  cairo_surface_t* surface;
  cairo_t* cairo;
};

void paint(const Drawing& drawing, cairo_t* cairo) {
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  Pen pen(cairo);
  drawing.draw(pen);
}

}  // namespace

void Pen::set(Colour colour) {
  cairo_set_source_rgba(cairo_, colour.red, colour.green, colour.blue, colour.opacity);
}

void Pen::line(double x0, double y0, double x1, double y1, Colour colour, double width, bool dashed) {
  const double dash[] = {4, 4};
  cairo_set_dash(cairo_, dash, dashed ? 2 : 0, 0);
  cairo_move_to(cairo_, x0, y0);
  cairo_line_to(cairo_, x1, y1);
  cairo_set_line_width(cairo_, width);
  set(colour);
  cairo_stroke(cairo_);
}

void Pen::box(double x, double y, double width, double height, Colour fill, Colour rim, double rim_width,
              double radius) {
  const double r = std::min({radius, 0.5 * width, 0.5 * height}), turn = 1.5707963267948966;
  cairo_new_sub_path(cairo_);
  cairo_arc(cairo_, x + width - r, y + r, r, -turn, 0);
  cairo_arc(cairo_, x + width - r, y + height - r, r, 0, turn);
  cairo_arc(cairo_, x + r, y + height - r, r, turn, 2 * turn);
  cairo_arc(cairo_, x + r, y + r, r, 2 * turn, 3 * turn);
  cairo_close_path(cairo_);
  set(fill);
  cairo_fill_preserve(cairo_);
  if (rim_width > 0) {
    cairo_set_dash(cairo_, nullptr, 0, 0);
    cairo_set_line_width(cairo_, rim_width);
    set(rim);
    cairo_stroke_preserve(cairo_);
  }
  cairo_new_path(cairo_);
}

void Pen::path(const Points& points, Colour colour, double width) {
  cairo_new_path(cairo_);
  for (const auto& [x, y] : points) cairo_line_to(cairo_, x, y);
  cairo_set_dash(cairo_, nullptr, 0, 0);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_width(cairo_, width);
  set(colour);
  cairo_stroke(cairo_);
}

void Pen::area(const Points& points, Colour fill) {
  cairo_new_path(cairo_);
  for (const auto& [x, y] : points) cairo_line_to(cairo_, x, y);
  cairo_close_path(cairo_);
  set(fill);
  cairo_fill(cairo_);
}

void Pen::clip(double x, double y, double width, double height) {
  cairo_save(cairo_);
  cairo_new_path(cairo_);
  cairo_rectangle(cairo_, x, y, width, height);
  cairo_clip(cairo_);
}

void Pen::unclip() {
  cairo_restore(cairo_);
}

void Pen::disc(double x, double y, double radius, Colour fill) {
  cairo_new_path(cairo_);
  cairo_arc(cairo_, x, y, radius, 0, 6.283185307179586);
  set(fill);
  cairo_fill(cairo_);
}

void Pen::diamond(double x, double y, double radius, Colour fill, Colour rim) {
  cairo_move_to(cairo_, x - radius, y);
  cairo_line_to(cairo_, x, y - radius);
  cairo_line_to(cairo_, x + radius, y);
  cairo_line_to(cairo_, x, y + radius);
  cairo_close_path(cairo_);
  set(fill);
  cairo_fill_preserve(cairo_);
  set(rim);
  cairo_set_dash(cairo_, nullptr, 0, 0);
  cairo_set_line_width(cairo_, 1.2);
  cairo_stroke(cairo_);
}

void Pen::text(double x, double y, double size, const std::string& words, Colour colour, double align,
               bool bold) {
  cairo_select_font_face(cairo_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_, size);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_, words.c_str(), &extents);
  set(colour);
  cairo_move_to(cairo_, x - align * extents.x_advance, y);
  cairo_show_text(cairo_, words.c_str());
}

std::string to_svg(const Drawing& drawing) {
  std::string text;
  const auto append = [](void* to, const unsigned char* data, unsigned int size) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
    return CAIRO_STATUS_SUCCESS;
  };
  Surface surface(cairo_svg_surface_create_for_stream(append, &text, drawing.width, drawing.height));
  paint(drawing, surface.cairo);
  cairo_surface_finish(surface.surface);
  const auto status = cairo_surface_status(surface.surface);
  if (status != CAIRO_STATUS_SUCCESS) throw IoError("SVG", 0, cairo_status_to_string(status));
  return text;
}

void save_png(const Drawing& drawing, const std::filesystem::path& file, double scale) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                             static_cast<int>(std::ceil(scale * drawing.width)),
                                             static_cast<int>(std::ceil(scale * drawing.height))));
  cairo_scale(surface.cairo, scale, scale);
  paint(drawing, surface.cairo);
  const auto status = cairo_surface_write_to_png(surface.surface, file.c_str());
  if (status != CAIRO_STATUS_SUCCESS)
    throw IoError(file.string(), 0, std::string("cannot be written: ") + cairo_status_to_string(status));
}

}  // namespace slalom::tools
