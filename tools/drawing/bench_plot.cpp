#include "tools/drawing/bench_plot.hpp"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "slalom/core/error.hpp"

namespace slalom::tools {

namespace {

constexpr double width = 900, height = 560, left = 80, right = 40, top = 50, bottom = 60;
constexpr double colours[][3] = {{0.12, 0.38, 0.70}, {0.85, 0.33, 0.10}, {0.20, 0.55, 0.25},
                                 {0.50, 0.25, 0.60}, {0.35, 0.35, 0.35}, {0.75, 0.55, 0.10}};

/// A range of decades or octaves on which values lie evenly by their logarithms.
struct Axis {
  double low = 1, high = 10, from = 0, to = 1;
  double operator()(double value) const {
    return from + (to - from) * (std::log(value) - std::log(low)) / (std::log(high) - std::log(low));
  }
};

void text(cairo_t* c, double x, double y, const std::string& words, double align) {
  cairo_text_extents_t extents;
  cairo_text_extents(c, words.c_str(), &extents);
  cairo_move_to(c, x - align * extents.width, y);
  cairo_show_text(c, words.c_str());
}

void line(cairo_t* c, double x0, double y0, double x1, double y1) {
  cairo_move_to(c, x0, y0);
  cairo_line_to(c, x1, y1);
  cairo_stroke(c);
}

void draw_axes(cairo_t* c, const Axis& x, const Axis& y) {
  cairo_set_line_width(c, 1);
  cairo_set_font_size(c, 13);
  for (double k = x.low; k <= x.high * 1.001; k *= 2) {
    cairo_set_source_rgb(c, 0.88, 0.88, 0.88);
    line(c, x(k), y.from, x(k), y.to);
    cairo_set_source_rgb(c, 0, 0, 0);
    if (std::fmod(std::round(std::log2(k)), 2) == 1)
      text(c, x(k), y.from + 20, std::to_string(std::lround(k)), 0.5);
  }
  for (double t = y.low; t <= y.high * 1.001; t *= 10) {
    cairo_set_source_rgb(c, 0.88, 0.88, 0.88);
    line(c, x.from, y(t), x.to, y(t));
    cairo_set_source_rgb(c, 0, 0, 0);
    char label[32];
    std::snprintf(label, sizeof label, "%g", t);
    text(c, x.from - 8, y(t) + 5, label, 1);
  }
  text(c, 0.5 * (x.from + x.to), height - 15, "samples K", 0.5);
  text(c, 12, top - 12, "solve time, ms (median)", 0);
}

}  // namespace

void plot_bench(const std::vector<BenchCurve>& curves, const std::string& title,
                const std::filesystem::path& file) {
  Axis x{1e9, 0, left, width - right}, y{1e9, 0, height - bottom, top};
  for (const BenchCurve& curve : curves) {
    for (std::size_t i = 0; i < curve.samples.size(); ++i) {
      x.low = std::min(x.low, curve.samples[i]);
      x.high = std::max(x.high, curve.samples[i]);
      y.low = std::min(y.low, curve.milliseconds[i]);
      y.high = std::max(y.high, curve.milliseconds[i]);
    }
  }
  y.low = std::pow(10, std::floor(std::log10(y.low)));
  y.high = std::pow(10, std::ceil(std::log10(y.high)));
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height)),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> context(cairo_create(surface.get()), cairo_destroy);
  cairo_t* c = context.get();
  cairo_set_source_rgb(c, 1, 1, 1);
  cairo_paint(c);
  cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  draw_axes(c, x, y);
  cairo_set_font_size(c, 15);
  text(c, width / 2, 24, title, 0.5);
  cairo_set_font_size(c, 13);
  cairo_set_line_width(c, 2);
  for (std::size_t n = 0; n < curves.size(); ++n) {
    const double* colour = colours[n % std::size(colours)];
    cairo_set_source_rgb(c, colour[0], colour[1], colour[2]);
    const BenchCurve& curve = curves[n];
    cairo_new_path(c);  // the words before have left a point
    for (std::size_t i = 0; i < curve.samples.size(); ++i)
      cairo_line_to(c, x(curve.samples[i]), y(curve.milliseconds[i]));
    cairo_stroke(c);
    text(c, left + 16, top + 24 + 18 * static_cast<double>(n), curve.name, 0);
  }
  if (cairo_surface_write_to_png(surface.get(), file.c_str()) != CAIRO_STATUS_SUCCESS)
    throw IoError(file, 0, "cannot be written");
}

}  // namespace slalom::tools
