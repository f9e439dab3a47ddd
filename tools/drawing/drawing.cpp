#include "tools/drawing/drawing.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <iterator>

#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"

namespace slalom::tools {
namespace {

constexpr double full_turn = 6.283185307179586;

using Surface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;

cairo_status_t append(void* text, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

void require(cairo_status_t status, const std::string& file) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw IoError(file, 0, std::string("cannot be drawn: ") + cairo_status_to_string(status));
}

void draw_on(const Surface& surface, const Drawing& drawing, double scale, const std::string& file) {
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_scale(cairo.get(), scale, scale);
  Pen pen(cairo.get());
  pen.fill_surface(white);
  drawing.draw(pen);
  require(cairo_status(cairo.get()), file);
}

/// The bytes of the drawing as an SVG or PDF document.
template <class Create>
std::string document(const Drawing& drawing, const std::string& file, Create create) {
  std::string bytes;
  const Surface surface(create(append, &bytes, drawing.width, drawing.height), cairo_surface_destroy);
  draw_on(surface, drawing, 1, file);
  cairo_surface_finish(surface.get());
  require(cairo_surface_status(surface.get()), file);
  return bytes;
}

/// The drawing as an image in memory.
Surface image_of(const Drawing& drawing, const std::string& file, double scale) {
  Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(scale * drawing.width)),
                                 static_cast<int>(std::ceil(scale * drawing.height))),
      cairo_surface_destroy);
  draw_on(surface, drawing, scale, file);
  cairo_surface_flush(surface.get());
  return surface;
}

std::string to_png(const Drawing& drawing, const std::string& file, double scale) {
  const Surface surface = image_of(drawing, file, scale);
  std::string bytes;
  require(cairo_surface_write_to_png_stream(surface.get(), append, &bytes), file);
  return bytes;
}

}  // namespace

Colour method_colour(std::string_view name) {
  static constexpr std::pair<std::string_view, Colour> methods[] = {
      {"svg_mppi", {0.12, 0.42, 0.78}}, {"mppi", {0.91, 0.45, 0.10}},   {"reverse_mppi", {0.20, 0.60, 0.36}},
      {"sv_mpc", {0.70, 0.25, 0.55}},   {"cem", {0.55, 0.42, 0.20}},    {"icem", {0.35, 0.35, 0.40}},
      {"dial_mpc", {0.10, 0.60, 0.65}}, {"generic", {0.82, 0.20, 0.22}}};
  const std::string_view word = name.substr(0, name.find_first_of(" ,"));
  std::size_t sum = 0;
  for (const char c : word) sum += static_cast<unsigned char>(c);
  for (const auto& [method, colour] : methods)
    if (method == word) return colour;
  return methods[sum % std::size(methods)].second;
}

Colour mixed(Colour a, Colour b, double share) {
  return {a.red + share * (b.red - a.red), a.green + share * (b.green - a.green),
          a.blue + share * (b.blue - a.blue), a.opacity + share * (b.opacity - a.opacity)};
}

Colour scale_colour(std::span<const Colour> stops, double value) {
  const double at = std::clamp(value, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mixed(stops[i], stops[i + 1], at - static_cast<double>(i));
}

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

Canvas::Canvas(double width, double height)
    : width_(width),
      height_(height),
      surface_(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, nullptr), cairo_surface_destroy),
      cairo_(cairo_create(surface_.get()), cairo_destroy),
      pen_(cairo_.get()) {}

Drawing Canvas::drawing() const {
  return {width_, height_, [surface = surface_.get()](Pen& pen) { pen.show(surface); }};
}

std::string to_svg(const Drawing& drawing) {
  return document(drawing, "SVG", cairo_svg_surface_create_for_stream);
}

std::string to_pixels(const Drawing& drawing) {
  const Surface surface = image_of(drawing, "picture", 1);  // a row has no padding
  const auto bytes = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get())) *
                     static_cast<std::size_t>(cairo_image_surface_get_height(surface.get()));
  return {reinterpret_cast<const char*>(cairo_image_surface_get_data(surface.get())), bytes};
}

void save(const Drawing& drawing, const std::filesystem::path& file, double scale) {
  const std::string ending = file.extension().string();
  const std::string bytes = ending == ".svg" ? to_svg(drawing)
                            : ending == ".pdf"
                                ? document(drawing, file.string(), cairo_pdf_surface_create_for_stream)
                                : to_png(drawing, file.string(), scale);
  write_file(file, bytes);
}

}  // namespace slalom::tools
