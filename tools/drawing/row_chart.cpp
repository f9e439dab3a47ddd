#include "tools/drawing/row_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/drawing/linear_axis.hpp"

namespace slalom::tools {
namespace {

constexpr Colour stripe{0.972, 0.976, 0.984, 1}, ours_fill{0.12, 0.42, 0.78, 1},
    ours_light{0.12, 0.42, 0.78, 0.28}, theirs_fill{0.55, 0.58, 0.64, 1},
    theirs_light{0.55, 0.58, 0.64, 0.25};
constexpr double row_height = 42, names_width = 250, panel_gap = 48, top = 62, bottom = 46, margin = 18,
                 panel_width = 300, thick = 13;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  const double rest = at - static_cast<double>(i);
  return i + 1 < sorted.size() ? sorted[i] * (1 - rest) + sorted[i + 1] * rest : sorted[i];
}

/// From values to pixels, and where its lines are.
struct Axis {
  bool logarithmic = true;
  double low = 0, high = 1, left = 0, width = panel_width;
  std::vector<double> ticks;

  double at(double value) const {
    const double share = logarithmic ? std::log(std::max(value, low) / low) / std::log(high / low)
                                     : (value - low) / (high - low);
    return left + width * std::clamp(share, 0.0, 1.0);
  }
};

std::vector<double> all_values(const Panel& panel) {
  std::vector<double> all;
  for (const auto* side : {&panel.ours, &panel.theirs}) {
    for (const Marks& marks : *side) {
      all.insert(all.end(), marks.values.begin(), marks.values.end());
      if (marks.span) all.insert(all.end(), {marks.span->value, marks.span->low, marks.span->high});
    }
  }
  std::erase_if(all, [](double v) { return !std::isfinite(v); });
  return all;
}

Axis linear_axis(const std::vector<double>& values) {
  Axis axis{.logarithmic = false, .ticks = {}};
  const double most = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  const double step = round_step(std::max(most, 1e-9) / 4);
  axis.high = std::max(step, step * std::ceil(most / step));
  for (int i = 0; i * step <= axis.high * (1 + 1e-9); ++i) axis.ticks.push_back(i * step);
  return axis;
}

Axis logarithmic_axis(std::vector<double> values) {
  Axis axis{.ticks = {}};
  std::erase_if(values, [](double v) { return v <= 0; });
  if (values.empty()) values = {1, 10};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double greatest = *most;
  const bool wide = greatest / *least > 200;
  std::vector<double> steps;
  for (int decade = -9; decade < 9; ++decade) {
    for (const double digit : {1.0, 2.0, 5.0})
      if (!wide || digit == 1) steps.push_back(digit * std::pow(10.0, decade));
  }
  axis.low = steps.front();
  for (const double step : steps)
    if (step <= *least) axis.low = step;
  axis.high = *std::find_if(steps.begin(), steps.end() - 1,
                            [&](double step) { return step >= greatest && step > axis.low; });
  for (const double step : steps)
    if (step >= axis.low * 0.999 && step <= axis.high * 1.001) axis.ticks.push_back(step);
  return axis;
}

void draw_box(Pen& pen, const Axis& axis, double y, std::vector<double> values, Colour fill, Colour light) {
  std::sort(values.begin(), values.end());
  const double q1 = quantile(values, 0.25), q3 = quantile(values, 0.75), reach = 1.5 * (q3 - q1);
  const double low = *std::find_if(values.begin(), values.end(), [&](double v) { return v >= q1 - reach; });
  const double high =
      *std::find_if(values.rbegin(), values.rend(), [&](double v) { return v <= q3 + reach; });
  pen.line(axis.at(low), y, axis.at(high), y, fill, 1.4);
  for (const double end : {low, high}) pen.line(axis.at(end), y - 3.5, axis.at(end), y + 3.5, fill, 1.4);
  for (const double v : values)
    if (v < low || v > high) pen.disc(axis.at(v), y, 1.9, {fill.red, fill.green, fill.blue, 0.55});
  const double left = axis.at(q1), width = std::max(1.5, axis.at(q3) - left);
  pen.box(left, y - thick / 2, width, thick, white);
  pen.box(left, y - thick / 2, width, thick, light, fill, 1.3);
  const double middle = axis.at(quantile(values, 0.5));
  pen.line(middle, y - thick / 2, middle, y + thick / 2, fill, 2.4);
  double sum = 0;
  for (const double v : values) sum += v;
  pen.diamond(axis.at(sum / static_cast<double>(values.size())), y, 4.2, white, fill);
}

void draw_marks(Pen& pen, const Panel& panel, const Axis& axis, double y, const Marks& marks, Colour fill,
                Colour light) {
  if (panel.kind == Panel::Kind::boxes) {
    if (!marks.values.empty()) draw_box(pen, axis, y, marks.values, fill, light);
    return;
  }
  if (!marks.span) return;
  const Span& span = *marks.span;
  const double x = axis.at(span.value);
  if (panel.kind == Panel::Kind::bars)
    pen.box(axis.left, y - thick / 2, std::max(1.0, x - axis.left), thick, light, fill, 1.3);
  pen.line(axis.at(span.low), y, axis.at(span.high), y, fill, 1.8);
  for (const double end : {span.low, span.high})
    pen.line(axis.at(end), y - 4, axis.at(end), y + 4, fill, 1.8);
  if (panel.kind == Panel::Kind::spans) pen.disc(x, y, 4.6, fill);
}

void draw_panel(Pen& pen, const Panel& panel, double left, std::size_t rows) {
  const auto values = all_values(panel);
  Axis axis = panel.kind == Panel::Kind::bars ? linear_axis(values) : logarithmic_axis(values);
  axis.left = left;
  const double end = top + row_height * static_cast<double>(rows);
  pen.text(left, top - 16, 15, panel.title, ink, 0, true);
  for (const double tick : axis.ticks) {
    pen.line(axis.at(tick), top, axis.at(tick), end, rule, 1);
    pen.text(axis.at(tick), end + 17, 12, number(tick), faint_ink, 0.5);
  }
  pen.text(left + panel_width / 2, end + 36, 12.5, panel.axis, faint_ink, 0.5);
  for (std::size_t i = 0; i < rows; ++i) {
    const double y = top + row_height * (static_cast<double>(i) + 0.5);
    const bool two = i < panel.theirs.size() && !panel.theirs.empty();
    draw_marks(pen, panel, axis, two ? y - 8.5 : y, panel.ours[i], ours_fill, ours_light);
    if (two) draw_marks(pen, panel, axis, y + 8.5, panel.theirs[i], theirs_fill, theirs_light);
  }
}

void draw_key(Pen& pen, const RowChart& chart) {
  double x = margin;
  for (const auto& [words, fill, light] : {std::tuple(chart.our_key, ours_fill, ours_light),
                                           std::tuple(chart.their_key, theirs_fill, theirs_light)}) {
    pen.box(x, 15, 18, 11, light, fill, 1.3);
    pen.text(x + 25, 25, 13, words, ink);
    x += 25 + 8.0 * static_cast<double>(words.size()) + 20;
  }
}

}  // namespace

Drawing draw_chart(const RowChart& chart) {
  const auto rows = chart.names.size(), panels = chart.panels.size();
  Drawing drawing;
  drawing.width = 2 * margin + names_width + static_cast<double>(panels) * panel_width +
                  static_cast<double>(panels - 1) * panel_gap;
  drawing.height = top + row_height * static_cast<double>(rows) + bottom;
  drawing.draw = [chart, rows, panels, width = drawing.width](Pen& pen) {
    for (std::size_t i = 0; i < rows; ++i) {
      const double y = top + row_height * static_cast<double>(i);
      if (i % 2 == 0) pen.box(margin / 2, y, width - margin, row_height, stripe, {}, 0, 4);
      pen.text(margin, y + row_height / 2 + 5, 14, chart.names[i], ink);
    }
    for (std::size_t p = 0; p < panels; ++p)
      draw_panel(pen, chart.panels[p],
                 margin + names_width + static_cast<double>(p) * (panel_width + panel_gap), rows);
    if (!chart.their_key.empty()) draw_key(pen, chart);
  };
  return drawing;
}

}  // namespace slalom::tools
