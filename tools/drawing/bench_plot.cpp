#include "tools/drawing/bench_plot.hpp"

#include <algorithm>
#include <cstdio>

#include "tools/drawing/axis.hpp"
#include "tools/drawing/drawing.hpp"

namespace slalom::tools {

namespace {

constexpr double width = 900, height = 560, left = 80, right = 40, top = 50, bottom = 60;

std::string tick_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void draw_axes(Pen& pen, const Axis& x, const Axis& y) {
  for (const double tick : x.ticks) {
    pen.line(x(tick), y.from, x(tick), y.to, rule, 1);
    pen.text(x(tick), y.from + 20, 13, tick_text(tick), ink, 0.5);
  }
  for (const double tick : y.ticks) {
    pen.line(x.from, y(tick), x.to, y(tick), rule, 1);
    pen.text(x.from - 8, y(tick) + 5, 13, tick_text(tick), ink, 1);
  }
  pen.text(0.5 * (x.from + x.to), height - 15, 13, "samples K", ink, 0.5);
  pen.text(12, top - 12, 13, "solve time, ms (median)", ink);
}

}  // namespace

void plot_bench(const std::vector<BenchCurve>& curves, const std::string& title,
                const std::filesystem::path& file) {
  std::vector<double> samples, milliseconds;
  for (const BenchCurve& curve : curves) {
    samples.insert(samples.end(), curve.samples.begin(), curve.samples.end());
    milliseconds.insert(milliseconds.end(), curve.milliseconds.begin(), curve.milliseconds.end());
  }
  const auto [fewest, most] = std::minmax_element(samples.begin(), samples.end());
  const auto [fastest, slowest] = std::minmax_element(milliseconds.begin(), milliseconds.end());
  const Axis x = logarithmic_axis(*fewest, *most, left, width - right),
             y = logarithmic_axis(*fastest, *slowest, height - bottom, top);
  const auto draw = [&](Pen& pen) {
    draw_axes(pen, x, y);
    pen.text(width / 2, 24, 15, title, ink, 0.5);
    for (std::size_t n = 0; n < curves.size(); ++n) {
      const BenchCurve& curve = curves[n];
      const Colour colour = method_colour(curve.name);
      Pen::Points points;
      for (std::size_t i = 0; i < curve.samples.size(); ++i)
        points.emplace_back(x(curve.samples[i]), y(curve.milliseconds[i]));
      pen.path(points, colour, 2);
      pen.text(left + 16, top + 24 + 18 * static_cast<double>(n), 13, curve.name, colour);
    }
  };
  save({width, height, draw}, file, 1);
}

}  // namespace slalom::tools
