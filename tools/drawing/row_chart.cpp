#include "tools/drawing/row_chart.hpp"

#include <algorithm>
#include <cmath>

#include "tools/command_line/words.hpp"

namespace slalom::tools {
namespace {

/// The least of 1, 2 and 5 times a power of ten that is not below `rough`, which must be above 0.
double round_step(double rough) {
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * decade >= rough) return digit * decade;
  return 10 * decade;
}

constexpr Colour stripe{0.972, 0.976, 0.984, 1}, ours_fill{0.12, 0.42, 0.78, 1},
    ours_light{0.12, 0.42, 0.78, 0.28}, theirs_fill{0.55, 0.58, 0.64, 1},
    theirs_light{0.55, 0.58, 0.64, 0.25};
constexpr double row_height = 42, names_width = 250, panel_gap = 48, top = 62, bottom = 46, margin = 18,
                 panel_width = 300, thick = 13;

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  const double rest = at - static_cast<double>(i);
  return i + 1 < sorted.size() ? sorted[i] * (1 - rest) + sorted[i + 1] * rest : sorted[i];
}

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

/// The axis of a panel whose left end is at a pixel.
Axis axis_of(const Panel& panel, double left) {
  std::vector<double> values = all_values(panel);
  const double right = left + panel_width;
  if (panel.kind == Panel::Kind::bars)
    return linear_axis(0,
                       values.empty() ? 1 : std::max(*std::max_element(values.begin(), values.end()), 1e-9),
                       left, right, 4);
  std::erase_if(values, [](double v) { return v <= 0; });
  if (values.empty()) values = {1, 10};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return logarithmic_axis(*least, *most, left, right);
}

void draw_box(Pen& pen, const Axis& axis, double y, std::vector<double> values, Colour fill, Colour light) {
  std::sort(values.begin(), values.end());
  const double q1 = quantile(values, 0.25), q3 = quantile(values, 0.75), reach = 1.5 * (q3 - q1);
  const double low = *std::find_if(values.begin(), values.end(), [&](double v) { return v >= q1 - reach; });
  const double high =
      *std::find_if(values.rbegin(), values.rend(), [&](double v) { return v <= q3 + reach; });
  pen.line(axis(low), y, axis(high), y, fill, 1.4);
  for (const double end : {low, high}) pen.line(axis(end), y - 3.5, axis(end), y + 3.5, fill, 1.4);
  for (const double v : values)
    if (v < low || v > high) pen.disc(axis(v), y, 1.9, {fill.red, fill.green, fill.blue, 0.55});
  const double left = axis(q1), width = std::max(1.5, axis(q3) - left);
  pen.box(left, y - thick / 2, width, thick, white);
  pen.box(left, y - thick / 2, width, thick, light, fill, 1.3);
  const double middle = axis(quantile(values, 0.5));
  pen.line(middle, y - thick / 2, middle, y + thick / 2, fill, 2.4);
  double sum = 0;
  for (const double v : values) sum += v;
  pen.diamond(axis(sum / static_cast<double>(values.size())), y, 4.2, white, fill);
}

void draw_marks(Pen& pen, const Panel& panel, const Axis& axis, double y, const Marks& marks, Colour fill,
                Colour light) {
  if (panel.kind == Panel::Kind::boxes) {
    if (!marks.values.empty()) draw_box(pen, axis, y, marks.values, fill, light);
    return;
  }
  if (!marks.span) return;
  const Span& span = *marks.span;
  const double x = axis(span.value);
  if (panel.kind == Panel::Kind::bars)
    pen.box(axis.from, y - thick / 2, std::max(1.0, x - axis.from), thick, light, fill, 1.3);
  pen.line(axis(span.low), y, axis(span.high), y, fill, 1.8);
  for (const double end : {span.low, span.high}) pen.line(axis(end), y - 4, axis(end), y + 4, fill, 1.8);
}

void draw_panel(Pen& pen, const Panel& panel, double left, std::size_t rows) {
  const Axis axis = axis_of(panel, left);
  const double end = top + row_height * static_cast<double>(rows);
  pen.text(left, top - 16, 15, panel.title, ink, 0, true);
  for (const double tick : axis.ticks) {
    pen.line(axis(tick), top, axis(tick), end, rule, 1);
    pen.text(axis(tick), end + 17, 12, short_number(tick), faint_ink, 0.5);
  }
  pen.text(left + panel_width / 2, end + 36, 12.5, panel.axis, faint_ink, 0.5);
  for (std::size_t i = 0; i < rows; ++i) {
    const double y = top + row_height * (static_cast<double>(i) + 0.5);
    const bool two = i < panel.theirs.size() && !panel.theirs.empty();
    draw_marks(pen, panel, axis, two ? y - 8.5 : y, panel.ours[i], ours_fill, ours_light);
    if (two) draw_marks(pen, panel, axis, y + 8.5, panel.theirs[i], theirs_fill, theirs_light);
  }
}

/// Draws a name beside its row: in up to three lines, broken after a space or a sign, and smaller if need be.
void draw_name(Pen& pen, const std::string& name, double middle) {
  constexpr double width = names_width - 16, least = 6;
  const auto lines_of = [&](double size) {
    std::vector<std::string> lines = {""};
    for (std::size_t begin = 0; begin < name.size();) {
      const std::size_t end = std::min(name.find_first_of(" ,=._", begin), name.size() - 1) + 1;
      const std::string part = name.substr(begin, end - begin);
      if (!lines.back().empty() && pen.text_width(lines.back() + part, size) > width) lines.emplace_back();
      lines.back() += part;
      begin = end;
    }
    return lines;
  };
  double size = 14;
  std::vector<std::string> lines = lines_of(size);
  const auto fits = [&] {
    return 1.2 * size * static_cast<double>(lines.size()) <= row_height - 3 &&
           std::all_of(lines.begin(), lines.end(),
                       [&](const std::string& line) { return pen.text_width(line, size) <= width; });
  };
  while (size > least && !fits()) lines = lines_of(--size);
  for (std::size_t i = 0; i < lines.size(); ++i)
    pen.text(margin,
             middle + 0.36 * size +
                 1.2 * size * (static_cast<double>(i) - 0.5 * static_cast<double>(lines.size() - 1)),
             size, lines[i], ink);
}

void draw_key(Pen& pen, const RowChart& chart) {
  double x = margin;
  for (const auto& [words, fill, light] : {std::tuple(std::string("Slalom"), ours_fill, ours_light),
                                           std::tuple(chart.their_key, theirs_fill, theirs_light)}) {
    pen.box(x, 15, 18, 11, light, fill, 1.3);
    pen.text(x + 25, 25, 13, words, ink);
    x += 25 + 8.0 * static_cast<double>(words.size()) + 20;
  }
}

}  // namespace

double Axis::operator()(double value) const {
  const double share = logarithmic
                           ? std::clamp(std::log(std::max(value, low) / low) / std::log(high / low), 0.0, 1.0)
                           : (value - low) / (high - low);
  return from + (to - from) * share;
}

Axis linear_axis(double low, double high, double from, double to, int steps, bool exact) {
  const double step = round_step((high - low) / steps);
  Axis axis{.low = low, .high = high, .from = from, .to = to, .ticks = {}};
  if (!exact) {
    axis.low = step * std::floor(low / step + 1e-9);
    axis.high = step * std::ceil(high / step - 1e-9);
  }
  // Counted, since a step is lost in a value of many more digits.
  const double first = std::ceil(axis.low / step - 1e-9);
  for (int k = 0; k <= 2 * steps + 2 && step * (first + k) <= axis.high + 1e-9 * step; ++k)
    axis.ticks.push_back(first + k == 0 ? 0 : step * (first + k));
  return axis;
}

Axis logarithmic_axis(double low, double high, double from, double to) {
  Axis axis{.low = 1e-9, .high = 1e9, .from = from, .to = to, .logarithmic = true, .ticks = {}};
  std::vector<double> steps;
  for (int decade = -9; decade < 9; ++decade)
    for (const double digit : {1.0, 2.0, 5.0})
      if (digit == 1 || high <= 200 * low) steps.push_back(digit * std::pow(10.0, decade));
  for (const double step : steps)
    if (step <= low) axis.low = step;
  axis.high = *std::find_if(steps.begin(), steps.end() - 1,
                            [&](double step) { return step >= high && step > axis.low; });
  for (const double step : steps)
    if (step >= axis.low * 0.999 && step <= axis.high * 1.001) axis.ticks.push_back(step);
  return axis;
}

Drawing draw_chart(const RowChart& chart) {
  const auto rows = chart.names.size(), panels = chart.panels.size();
  const double width = 2 * margin + names_width + static_cast<double>(panels) * panel_width +
                       static_cast<double>(panels - 1) * panel_gap;
  constexpr double heading = 44;
  const auto draw = [chart, rows, panels, width](Pen& pen) {
    pen.text(margin, 30, 17, chart.title, ink, 0, true);
    pen.text(width - margin, 30, 12, chart.note, faint_ink, 1);
    pen.shift(0, heading);
    for (std::size_t i = 0; i < rows; ++i) {
      const double y = top + row_height * static_cast<double>(i);
      if (i % 2 == 0) pen.box(margin / 2, y, width - margin, row_height, stripe, {}, 0, 4);
      draw_name(pen, chart.names[i], y + row_height / 2);
    }
    for (std::size_t p = 0; p < panels; ++p)
      draw_panel(pen, chart.panels[p],
                 margin + names_width + static_cast<double>(p) * (panel_width + panel_gap), rows);
    if (!chart.their_key.empty()) draw_key(pen, chart);
  };
  return {width, heading + top + row_height * static_cast<double>(rows) + bottom, draw};
}

}  // namespace slalom::tools
