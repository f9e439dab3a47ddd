#include "tools/drawing/pen.hpp"

#include <cairo.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "slalom/core/error.hpp"

namespace slalom::tools {

namespace {

constexpr double full_turn = 6.283185307179586;
// Files and folders that fontconfig has open at the same time: its configuration includes others. With too
// few it takes another font.
constexpr std::size_t font_files = 8;

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

void Pen::trace(const Points& points) {
  cairo_new_path(cairo_);
  for (const auto& [x, y] : points) cairo_line_to(cairo_, x, y);
}

void Pen::path(const Points& points, Colour colour, double width) {
  stroke(points, {.colour = colour, .width = width});
}

void Pen::stroke(const Points& points, const Stroke& line, bool closed) {
  trace(points);
  if (closed) cairo_close_path(cairo_);
  const double dash[] = {line.dash, line.dash};
  cairo_set_dash(cairo_, dash, line.dash > 0 ? 2 : 0, 0);
  cairo_set_line_width(cairo_, line.width);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cairo_, line.round_caps ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  set(line.colour);
  cairo_stroke(cairo_);
  cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_BUTT);
}

void Pen::area(const Points& points, Colour fill) {
  trace(points);
  cairo_close_path(cairo_);
  set(fill);
  cairo_fill(cairo_);
}

void Pen::area(const Points& points, Colour fill, Colour rim, double rim_width) {
  area(points, fill);
  stroke(points, {.colour = rim, .width = rim_width}, true);
}

void Pen::rectangle(double x, double y, double width, double height, Colour fill) {
  cairo_new_path(cairo_);
  cairo_rectangle(cairo_, x, y, width, height);
  set(fill);
  cairo_fill(cairo_);
}

void Pen::fill_surface(Colour colour) {
  set(colour);
  cairo_paint(cairo_);
}

void Pen::image(std::vector<std::uint32_t>& pixels, int width) {
  const int stride = cairo_format_stride_for_width(CAIRO_FORMAT_RGB24, width);  // always 4 bytes a pixel
  cairo_surface_t* source =
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(pixels.data()), CAIRO_FORMAT_RGB24,
                                          width, static_cast<int>(pixels.size()) / width, stride);
  cairo_set_source_surface(cairo_, source, 0, 0);
  cairo_paint(cairo_);
  // The surface may keep a reference to its last source, and the pixels do not outlive this call.
  set({});
  cairo_surface_destroy(source);
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
  disc(x, y, radius, fill, {}, 0);
}

void Pen::disc(double x, double y, double radius, Colour fill, Colour rim, double rim_width) {
  cairo_new_path(cairo_);
  cairo_arc(cairo_, x, y, radius, 0, full_turn);
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

void require_font_files() {
  std::array<int, font_files> opened{};
  std::size_t count = 0;
  int reason = 0;
  for (; count < opened.size(); ++count) {
    opened[count] = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (opened[count] >= 0) continue;
    reason = errno;
    break;
  }
  for (std::size_t i = 0; i < count; ++i) ::close(opened[i]);
  if (reason == EMFILE || reason == ENFILE)
    throw std::runtime_error("a picture cannot be drawn: its fonts need " + std::to_string(font_files) +
                             " free file descriptors, and " + std::to_string(count) + " are free (" +
                             std::generic_category().message(reason) + "); raise the limit (ulimit -n)");
}

Surface::Surface(int width, int height, double scale)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy),
      cairo_(cairo_create(surface_.get()), cairo_destroy) {
  require_font_files();
  cairo_scale(cairo_.get(), scale, scale);
}

void Surface::save(const std::filesystem::path& file) const {
  // After an error nothing more is drawn.
  if (const auto drawn = cairo_status(cairo_.get()); drawn != CAIRO_STATUS_SUCCESS)
    throw IoError(file.string(), 0, std::string("cannot be drawn: ") + cairo_status_to_string(drawn));
  const auto status = cairo_surface_write_to_png(surface_.get(), file.c_str());
  if (status != CAIRO_STATUS_SUCCESS)
    throw IoError(file.string(), 0, std::string("cannot be written: ") + cairo_status_to_string(status));
}

}  // namespace slalom::tools
