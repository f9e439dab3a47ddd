#include "tools/drawing/canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "slalom/core/error.hpp"

namespace slalom::tools {
namespace {

constexpr Colour paper{1, 1, 1, 1};
constexpr Colour ground{0.925, 0.935, 0.95, 1};  // what lies beyond the walls
constexpr Colour road{1, 1, 1, 1};
constexpr Colour wall{0.20, 0.24, 0.32, 1};
constexpr Colour ink{0.13, 0.16, 0.22, 1};
constexpr Colour faint_ink{0.42, 0.46, 0.54, 1};

std::uint32_t argb(Colour c) {
  const auto byte = [](double v) {
    return static_cast<std::uint32_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
  };
  return 0xFF000000u | byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

Colour mixed(Colour a, Colour b, double share) {
  return {a.red + share * (b.red - a.red), a.green + share * (b.green - a.green),
          a.blue + share * (b.blue - a.blue), a.opacity + share * (b.opacity - a.opacity)};
}

/// A value per cell, read between the cells' centres.
struct Field {
  int width = 0, height = 0;
  std::vector<float> values;

  double cell(int column, int row) const {
    if (column < 0 || row < 0 || column >= width || row >= height) return 0;
    return values[static_cast<std::size_t>(row) * width + column];
  }
  double at(double column, double row) const {
    const double left = std::floor(column), low = std::floor(row), s = column - left, t = row - low;
    const int i = static_cast<int>(left), j = static_cast<int>(low);
    return (1 - t) * ((1 - s) * cell(i, j) + s * cell(i + 1, j)) +
           t * ((1 - s) * cell(i, j + 1) + s * cell(i + 1, j + 1));
  }
};

/// 1 on the cells of one kind, 0 elsewhere, blurred a little: its contours lack the cells' steps.
Field smoothed_cells(const maps::OccupancyGrid& map, maps::Occupancy kind) {
  static constexpr std::array<double, 3> weights = {0.40, 0.24, 0.06};  // a Gaussian of about one cell
  Field field{map.width, map.height, {}}, across = field;
  for (const auto cell : map.cells) field.values.push_back(cell == kind ? 1.0f : 0.0f);
  const auto blur = [&](const Field& from, int dx, int dy) {
    std::vector<float> values(from.values.size());
    for (int row = 0; row < map.height; ++row)
      for (int column = 0; column < map.width; ++column) {
        double sum = weights[0] * from.cell(column, row);
        for (int k = 1; k <= 2; ++k)
          sum += weights[k] *
                 (from.cell(column + k * dx, row + k * dy) + from.cell(column - k * dx, row - k * dy));
        values[static_cast<std::size_t>(row) * map.width + column] = static_cast<float>(sum);
      }
    return values;
  };
  across.values = blur(field, 1, 0);
  field.values = blur(across, 0, 1);
  return field;
}

/// How far a pixel lies inside a contour at `level`, 0..1, over about one pixel; `cell` is a cell's size in
/// pixels.
double edge(double value, double level, double cell) {
  return std::clamp(0.5 + (value - level) * 2.5 * std::max(cell, 1.0), 0.0, 1.0);
}

/// A round length for a scale bar that is at most `longest` m.
double round_length(double longest) {
  const double decade = std::pow(10, std::floor(std::log10(longest)));
  for (const double digit : {5.0, 2.0})
    if (digit * decade <= longest) return digit * decade;
  return decade;
}

std::string number(double value, int digits) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.*f", digits, value);
  return buffer;
}

}  // namespace

Colour speed_colour(double value) {
  static const std::array<Colour, 6> stops = {{{0.16, 0.22, 0.62},
                                               {0.08, 0.47, 0.76},
                                               {0.05, 0.64, 0.55},
                                               {0.55, 0.74, 0.20},
                                               {0.96, 0.66, 0.11},
                                               {0.86, 0.19, 0.18}}};
  const double at = std::clamp(value, 0.0, 1.0) * (stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mixed(stops[i], stops[i + 1], at - static_cast<double>(i));
}

Canvas::Canvas(const maps::OccupancyGrid& map, int long_side) {
  const double wide = map.width * map.resolution, high = map.height * map.resolution;
  scale_ = long_side / std::max(wide, high);
  left_ = map.origin.x;
  top_ = map.origin.y + high;
  map_height_ = static_cast<int>(std::ceil(high * scale_));
  width_ = std::max(static_cast<int>(std::ceil(wide * scale_)), 900);
  band_ = 150;
  left_ -= 0.5 * (width_ / scale_ - wide);
  surface_.reset(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_, map_height_ + band_));
  cairo_.reset(cairo_create(surface_.get()));
  set(ground);
  cairo_paint(cairo_.get());
  draw_cells(map);
  set(paper);
  cairo_rectangle(cairo_.get(), 0, map_height_, width_, band_);
  cairo_fill(cairo_.get());
}

void Canvas::draw_cells(const maps::OccupancyGrid& map) {
  const Field walls = smoothed_cells(map, maps::Occupancy::occupied),
              roads = smoothed_cells(map, maps::Occupancy::free);
  cairo_surface_flush(surface_.get());
  auto* data = cairo_image_surface_get_data(surface_.get());
  const int stride = cairo_image_surface_get_stride(surface_.get());
  for (int y = 0; y < map_height_; ++y) {
    auto* line = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
    for (int x = 0; x < width_; ++x) {
      const maps::Point at =
          maps::inverse_transform(map.origin, {left_ + (x + 0.5) / scale_, top_ - (y + 0.5) / scale_});
      const double column = at.x / map.resolution - 0.5, row = at.y / map.resolution - 0.5;
      const Colour below = mixed(ground, road, edge(roads.at(column, row), 0.5, scale_ * map.resolution));
      line[x] = argb(mixed(below, wall, edge(walls.at(column, row), 0.35, scale_ * map.resolution)));
    }
  }
  cairo_surface_mark_dirty(surface_.get());
}

maps::Point Canvas::pixel(const maps::Point& point) const {
  return {(point.x - left_) * scale_, (top_ - point.y) * scale_};
}

void Canvas::set(Colour colour) {
  cairo_set_source_rgba(cairo_.get(), colour.red, colour.green, colour.blue, colour.opacity);
}

void Canvas::line(const std::vector<maps::Point>& points, Colour colour, double width, bool closed,
                  bool dashed) {
  cairo_t* c = cairo_.get();
  for (const auto& point : points) {
    const maps::Point at = pixel(point);
    cairo_line_to(c, at.x, at.y);
  }
  if (closed) cairo_close_path(c);
  const double dash[] = {9, 9};
  cairo_set_dash(c, dash, dashed ? 2 : 0, 0);
  cairo_set_line_width(c, width);
  cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(c, dashed ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
  set(colour);
  cairo_stroke(c);
  cairo_set_dash(c, nullptr, 0, 0);
}

void Canvas::speed_line(const std::vector<maps::Point>& points, const std::vector<double>& speeds,
                        double slowest, double fastest, double width, bool closed) {
  const std::size_t n = points.size();
  const double span = std::max(fastest - slowest, 1e-9);
  for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
    const std::size_t next = (i + 1) % n;
    const double speed = 0.5 * (speeds[i] + speeds[next]);
    line({points[i], points[next]}, speed_colour((speed - slowest) / span), width, false);
  }
}

void Canvas::polygon(const std::vector<maps::Point>& corners, Colour fill, Colour rim) {
  cairo_t* c = cairo_.get();
  for (const auto& corner : corners) {
    const maps::Point at = pixel(corner);
    cairo_line_to(c, at.x, at.y);
  }
  cairo_close_path(c);
  set(fill);
  cairo_fill_preserve(c);
  set(rim);
  cairo_set_line_width(c, 2);
  cairo_stroke(c);
}

void Canvas::disc(const maps::Point& centre, double radius, Colour fill) {
  cairo_t* c = cairo_.get();
  const maps::Point at = pixel(centre);
  cairo_arc(c, at.x, at.y, radius, 0, 6.283185307179586);
  set(fill);
  cairo_fill_preserve(c);
  set(paper);
  cairo_set_line_width(c, 2.5);
  cairo_stroke(c);
}

void Canvas::arrow(const maps::Pose& at, double size, Colour fill) {
  cairo_t* c = cairo_.get();
  const maps::Point centre = pixel({at.x, at.y});
  cairo_save(c);
  cairo_translate(c, centre.x, centre.y);
  cairo_rotate(c, -at.yaw);
  cairo_move_to(c, size, 0);
  cairo_line_to(c, -0.7 * size, 0.75 * size);
  cairo_line_to(c, -0.3 * size, 0);
  cairo_line_to(c, -0.7 * size, -0.75 * size);
  cairo_close_path(c);
  set(fill);
  cairo_fill_preserve(c);
  set(paper);
  cairo_set_line_width(c, 2.5);
  cairo_stroke(c);
  cairo_restore(c);
}

void Canvas::text(double x, double y, double size, const std::string& words, Colour colour, bool bold,
                  double align) {
  cairo_t* c = cairo_.get();
  cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, size);
  cairo_text_extents_t extents;
  cairo_text_extents(c, words.c_str(), &extents);
  set(colour);
  cairo_move_to(c, x - align * extents.x_advance, y);
  cairo_show_text(c, words.c_str());
}

std::vector<std::string> Canvas::wrapped(const std::string& words, double size, double width) {
  static const std::string separator = " \xC2\xB7 ";
  cairo_t* c = cairo_.get();
  cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, size);
  std::vector<std::string> lines = {""};
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(separator, begin), words.size());
    const std::string part = words.substr(begin, end - begin);
    const std::string longer = lines.back().empty() ? part : lines.back() + separator + part;
    cairo_text_extents_t extents;
    cairo_text_extents(c, longer.c_str(), &extents);
    if (lines.back().empty() || extents.x_advance <= width)
      lines.back() = longer;
    else
      lines.push_back(part);
    begin = end + separator.size();
  }
  return lines;
}

double Canvas::fitting_size(const std::string& words, double size, double least, double width) {
  cairo_t* c = cairo_.get();
  cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
  cairo_set_font_size(c, size);
  cairo_text_extents_t extents;
  cairo_text_extents(c, words.c_str(), &extents);
  return std::clamp(size * width / std::max(extents.x_advance, 1.0), least, size);
}

void Canvas::legend(const std::string& title, const std::string& facts, double slowest, double fastest) {
  cairo_t* c = cairo_.get();
  const double margin = 36, base = map_height_;
  const double bar_width = 260, bar_left = width_ - margin - bar_width, bar_top = base + 84;
  // A lap of an evaluation is named by all that was set for it.
  text(margin, base + 64, fitting_size(title, 40, 14, bar_left - 3 * margin), title, ink, true, 0);

  const auto lines = wrapped(facts, 22, bar_left - 2 * margin);
  for (std::size_t i = 0; i < lines.size(); ++i)
    text(margin, base + (lines.size() == 1 ? 108 : 100) + 30 * static_cast<double>(i), 22, lines[i],
         faint_ink, false, 0);
  for (int k = 0; k < static_cast<int>(bar_width); ++k) {
    set(speed_colour(k / (bar_width - 1)));
    cairo_rectangle(c, bar_left + k, bar_top, 1.5, 14);
    cairo_fill(c);
  }
  text(bar_left, bar_top + 38, 20, number(slowest, 1), faint_ink, false, 0);
  text(bar_left + bar_width, bar_top + 38, 20, number(fastest, 1) + " m/s", faint_ink, false, 1);

  scale_bar(bar_width, width_ - margin, base + 46);
}

void Canvas::scale_bar(double longest, double right, double at) {
  cairo_t* c = cairo_.get();
  const double metres = round_length(longest / scale_), pixels = metres * scale_;
  set(ink);
  cairo_set_line_width(c, 3);
  cairo_set_line_cap(c, CAIRO_LINE_CAP_BUTT);
  cairo_move_to(c, right - pixels, at - 8);
  cairo_line_to(c, right - pixels, at);
  cairo_line_to(c, right, at);
  cairo_line_to(c, right, at - 8);
  cairo_stroke(c);
  text(right - pixels - 12, at + 2, 20, number(metres, metres < 1 ? 1 : 0) + " m", faint_ink, false, 1);
}

void Canvas::key(const std::string& title, const std::string& facts,
                 const std::vector<std::pair<std::string, Colour>>& entries) {
  cairo_t* c = cairo_.get();
  const double margin = 36, base = map_height_;
  text(margin, base + 56, 36, title, ink, true, 0);
  text(margin, base + 92, 21, facts, faint_ink, false, 0);
  double left = margin;
  for (const auto& [words, colour] : entries) {
    set(colour);
    cairo_rectangle(c, left, base + 116, 26, 12);
    cairo_fill(c);
    text(left + 36, base + 129, 20, words, ink, false, 0);
    cairo_text_extents_t extents;
    cairo_text_extents(c, words.c_str(), &extents);
    left += 36 + extents.x_advance + 34;
  }
  scale_bar(260, width_ - margin, base + 46);
}

void Canvas::save(const std::filesystem::path& file) const {
  const auto status = cairo_surface_write_to_png(surface_.get(), file.c_str());
  if (status != CAIRO_STATUS_SUCCESS)
    throw IoError(file.string(), 0, std::string("cannot be written: ") + cairo_status_to_string(status));
}

maps::OccupancyGrid cropped(const maps::OccupancyGrid& map, const std::vector<maps::Point>& points,
                            double margin) {
  double low_x = 1e300, low_y = 1e300, high_x = -1e300, high_y = -1e300;
  for (const maps::Point& point : points) {
    const maps::Point at = maps::inverse_transform(map.origin, point);
    low_x = std::min(low_x, at.x);
    low_y = std::min(low_y, at.y);
    high_x = std::max(high_x, at.x);
    high_y = std::max(high_y, at.y);
  }
  const auto cell = [&](double metres, int count) {
    return std::clamp(static_cast<int>(std::floor(metres / map.resolution)), 0, count);
  };
  const int left = cell(low_x - margin, map.width), right = cell(high_x + margin, map.width);
  const int low = cell(low_y - margin, map.height), high = cell(high_y + margin, map.height);
  if (right <= left || high <= low) return map;
  maps::OccupancyGrid part;
  part.width = right - left;
  part.height = high - low;
  part.resolution = map.resolution;
  const maps::Point corner = maps::transform(map.origin, {left * map.resolution, low * map.resolution});
  part.origin = {corner.x, corner.y, map.origin.yaw};
  for (int row = low; row < high; ++row)
    for (int column = left; column < right; ++column) part.cells.push_back(map.at(column, row));
  return part;
}

}  // namespace slalom::tools
