#include "tools/drawing/bench_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "tools/drawing/drawing.hpp"

namespace slalom::tools {

namespace {

constexpr double width = 900, height = 560, left = 80, right = 40, top = 50, bottom = 60;
constexpr Colour colours[] = {{0.12, 0.38, 0.70}, {0.85, 0.33, 0.10}, {0.20, 0.55, 0.25},
                              {0.50, 0.25, 0.60}, {0.35, 0.35, 0.35}, {0.75, 0.55, 0.10}};

/// A range of decades or octaves on which values lie evenly by their logarithms.
struct Axis {
  double low = 1, high = 10, from = 0, to = 1;
  double operator()(double value) const {
    return from + (to - from) * (std::log(value) - std::log(low)) / (std::log(high) - std::log(low));
  }
};

void draw_axes(Pen& pen, const Axis& x, const Axis& y) {
  for (double k = x.low; k <= x.high * 1.001; k *= 2) {
    pen.line(x(k), y.from, x(k), y.to, rule, 1);
    if (std::fmod(std::round(std::log2(k)), 2) == 1)
      pen.text(x(k), y.from + 20, 13, std::to_string(std::lround(k)), ink, 0.5);
  }
  for (double t = y.low; t <= y.high * 1.001; t *= 10) {
    pen.line(x.from, y(t), x.to, y(t), rule, 1);
    char label[32];
    std::snprintf(label, sizeof label, "%g", t);
    pen.text(x.from - 8, y(t) + 5, 13, label, ink, 1);
  }
  pen.text(0.5 * (x.from + x.to), height - 15, 13, "samples K", ink, 0.5);
  pen.text(12, top - 12, 13, "solve time, ms (median)", ink);
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
  const auto draw = [&](Pen& pen) {
    draw_axes(pen, x, y);
    pen.text(width / 2, 24, 15, title, ink, 0.5);
    for (std::size_t n = 0; n < curves.size(); ++n) {
      const BenchCurve& curve = curves[n];
      const Colour& colour = colours[n % std::size(colours)];
      Pen::Points points;
      for (std::size_t i = 0; i < curve.samples.size(); ++i)
        points.emplace_back(x(curve.samples[i]), y(curve.milliseconds[i]));
      pen.path(points, colour, 2);
      pen.text(left + 16, top + 24 + 18 * static_cast<double>(n), 13, curve.name, colour);
    }
  };
  save_png({width, height, draw}, file, 1);
}

}  // namespace slalom::tools
