#include "tools/drawing/drawing.hpp"

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include <cmath>

#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"

namespace slalom::tools {
namespace {

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
