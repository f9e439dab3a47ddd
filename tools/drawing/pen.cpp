#include "tools/drawing/pen.hpp"

#include <cairo.h>

#include <algorithm>
#include <cstring>

namespace slalom::tools {

namespace {

constexpr double full_turn = 6.283185307179586;

}  // namespace

void Pen::set(Colour colour) {
  cairo_set_source_rgba(cairo_, colour.red, colour.green, colour.blue, colour.opacity);
}

void Pen::paint(Colour fill, Colour rim, double rim_width) {
  set(fill);
  cairo_fill_preserve(cairo_);
  if (rim_width > 0) outline({.colour = rim, .width = rim_width});
  cairo_new_path(cairo_);
}

void Pen::outline(const Stroke& line) {
  const double dash[] = {line.dash, line.dash};
  cairo_set_dash(cairo_, dash, line.dash > 0 ? 2 : 0, 0);
  cairo_set_line_width(cairo_, line.width);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cairo_, line.round_caps ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  set(line.colour);
  cairo_stroke_preserve(cairo_);
}

void Pen::trace(const Points& points, bool closed) {
  cairo_new_path(cairo_);
  for (const auto& [x, y] : points) cairo_line_to(cairo_, x, y);
  if (closed) cairo_close_path(cairo_);
}

void Pen::line(double x0, double y0, double x1, double y1, Colour colour, double width, bool dashed) {
  stroke({{x0, y0}, {x1, y1}}, {.colour = colour, .width = width, .dash = dashed ? 4.0 : 0.0});
}

void Pen::path(const Points& points, Colour colour, double width) {
  stroke(points, {.colour = colour, .width = width});
}

void Pen::stroke(const Points& points, const Stroke& line, bool closed) {
  trace(points, closed);
  outline(line);
  cairo_new_path(cairo_);
}

void Pen::area(const Points& points, Colour fill, Colour rim, double rim_width) {
  trace(points, true);
  paint(fill, rim, rim_width);
}

void Pen::rectangle(double x, double y, double width, double height, Colour fill) {
  area({{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, fill);
}

void Pen::box(double x, double y, double width, double height, Colour fill, Colour rim, double rim_width,
              double radius) {
  const double r = std::min({radius, 0.5 * width, 0.5 * height}), turn = 0.25 * full_turn;
  cairo_new_sub_path(cairo_);
  cairo_arc(cairo_, x + width - r, y + r, r, -turn, 0);
  cairo_arc(cairo_, x + width - r, y + height - r, r, 0, turn);
  cairo_arc(cairo_, x + r, y + height - r, r, turn, 2 * turn);
  cairo_arc(cairo_, x + r, y + r, r, 2 * turn, 3 * turn);
  cairo_close_path(cairo_);
  paint(fill, rim, rim_width);
}

void Pen::disc(double x, double y, double radius, Colour fill, Colour rim, double rim_width) {
  cairo_new_path(cairo_);
  cairo_arc(cairo_, x, y, radius, 0, full_turn);
  paint(fill, rim, rim_width);
}

void Pen::diamond(double x, double y, double radius, Colour fill, Colour rim) {
  area({{x - radius, y}, {x, y - radius}, {x + radius, y}, {x, y + radius}}, fill, rim, 1.2);
}

void Pen::fill_surface(Colour colour) {
  set(colour);
  cairo_paint(cairo_);
}

void Pen::show(cairo_surface_t* surface) {
  cairo_set_source_surface(cairo_, surface, 0, 0);
  cairo_paint(cairo_);
  set({});  // keeps no reference to the surface
}

void Pen::image(const std::vector<std::uint32_t>& pixels, int width) {
  const int height = static_cast<int>(pixels.size()) / width;
  cairo_surface_t* source = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  if (unsigned char* const bytes = cairo_image_surface_get_data(source)) {
    std::memcpy(bytes, pixels.data(), pixels.size() * sizeof pixels[0]);  // a row has no padding
    cairo_surface_mark_dirty(source);
  }
  show(source);
  cairo_surface_destroy(source);
}

void Pen::clip(double x, double y, double width, double height) {
  cairo_save(cairo_);
  cairo_new_path(cairo_);
  cairo_rectangle(cairo_, x, y, width, height);
  cairo_clip(cairo_);
}

void Pen::shift(double x, double y) {
  cairo_translate(cairo_, x, y);
}

void Pen::unclip() {
  cairo_restore(cairo_);
}

void Pen::set_font(double size, bool bold) {
  cairo_select_font_face(cairo_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_, size);
}

double Pen::text_width(const std::string& words, double size, bool bold) {
  set_font(size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_, words.c_str(), &extents);
  return extents.x_advance;
}

void Pen::text(double x, double y, double size, const std::string& words, Colour colour, double align,
               bool bold) {
  const double width = text_width(words, size, bold);
  set(colour);
  cairo_move_to(cairo_, x - align * width, y);
  cairo_show_text(cairo_, words.c_str());
}

}  // namespace slalom::tools
