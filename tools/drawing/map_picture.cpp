#include "tools/drawing/map_picture.hpp"
#include "tools/command_line/words.hpp"

#include <array>

namespace slalom::tools {
namespace {

constexpr int band = 150;  // pixels of the band below the map

/// A round length for a scale bar that is at most `longest` m.
double round_length(double longest) {
  const double decade = std::pow(10, std::floor(std::log10(longest)));
  for (const double digit : {5.0, 2.0})
    if (digit * decade <= longest) return digit * decade;
  return decade;
}

constexpr Colour ground{0.925, 0.935, 0.95};  // beyond the walls
constexpr Colour road{1, 1, 1};
constexpr Colour wall{0.20, 0.24, 0.32};

/// The part of a map within `margin` around the points; all of it if there are none or if they are elsewhere.
Bounds bounds_of(const maps::OccupancyGrid& map, const std::vector<maps::Point>& points, double margin) {
  const double along = map.width * map.resolution, across = map.height * map.resolution;
  Bounds whole, part;
  for (const maps::Point& corner : {maps::Point{0, 0}, {along, 0}, {along, across}, {0, across}})
    whole.include(maps::transform(map.origin, corner));
  for (const maps::Point& point : points) part.include(point, margin);
  part = {std::max(part.left, whole.left), std::min(part.right, whole.right), std::max(part.low, whole.low),
          std::min(part.top, whole.top)};
  return part.left < part.right && part.low < part.top ? part : whole;
}

MapView view_of(const Bounds& bounds, int long_side) {
  const double wide = bounds.right - bounds.left, high = bounds.top - bounds.low;
  MapView view{.scale = long_side / std::max(wide, high)};
  view.height = static_cast<int>(std::ceil(high * view.scale - 1e-6));
  view.width = std::max(static_cast<int>(std::ceil(wide * view.scale - 1e-6)), 900);
  view.left = bounds.left - 0.5 * (view.width / view.scale - wide);
  view.top = bounds.top;
  return view;
}

std::uint32_t argb(Colour c) {
  const auto byte = [](double v) {
    return static_cast<std::uint32_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
  };
  return 0xFF000000u | byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

/// A value per cell, read between the cells' centres.
struct CellValues {
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

/// Values of 1 on the cells of a kind and 0 elsewhere, blurred a little: contours lack the cells' steps.
CellValues smoothed_cells(const maps::OccupancyGrid& map, maps::Occupancy kind) {
  static constexpr std::array<double, 3> weights = {0.40, 0.24, 0.06};  // a Gaussian of about one cell
  CellValues smoothed{map.width, map.height, {}}, across = smoothed;
  for (const auto cell : map.cells) smoothed.values.push_back(cell == kind ? 1.0f : 0.0f);
  const auto blur = [&](const CellValues& from, int dx, int dy) {
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
  across.values = blur(smoothed, 1, 0);
  smoothed.values = blur(across, 0, 1);
  return smoothed;
}

/// The depth of a pixel inside a contour at `level`, 0..1, over about a pixel; `cell` is its size in pixels.
double edge(double value, double level, double cell) {
  return std::clamp(0.5 + (value - level) * 2.5 * std::max(cell, 1.0), 0.0, 1.0);
}

}  // namespace

std::vector<std::uint32_t> map_pixels(const maps::OccupancyGrid& map, const MapView& view) {
  const CellValues walls = smoothed_cells(map, maps::Occupancy::occupied),
                   roads = smoothed_cells(map, maps::Occupancy::free);
  std::vector<std::uint32_t> pixels;
  pixels.reserve(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const double cell = view.scale * map.resolution;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const maps::Point at = maps::inverse_transform(
          map.origin, {view.left + (x + 0.5) / view.scale, view.top - (y + 0.5) / view.scale});
      const double column = at.x / map.resolution - 0.5, row = at.y / map.resolution - 0.5;
      const Colour below = mixed(ground, road, edge(roads.at(column, row), 0.5, cell));
      pixels.push_back(argb(mixed(below, wall, edge(walls.at(column, row), 0.35, cell))));
    }
  }
  return pixels;
}

MapPicture::MapPicture(const maps::OccupancyGrid& map, int long_side, const std::vector<maps::Point>& points,
                       double margin)
    : view_(view_of(bounds_of(map, points, margin), long_side)), canvas_(view_.width, view_.height + band) {
  pen_.image(map_pixels(map, view_), view_.width);
}

Pen::Points MapPicture::pixels(const std::vector<maps::Point>& points) const {
  Pen::Points all;
  for (const maps::Point& point : points) {
    const maps::Point at = view_.pixel(point);
    all.emplace_back(at.x, at.y);
  }
  return all;
}

void MapPicture::line(const std::vector<maps::Point>& points, Colour colour, double width, bool closed,
                      bool dashed) {
  pen_.stroke(pixels(points),
              {.colour = colour, .width = width, .dash = dashed ? 9.0 : 0.0, .round_caps = !dashed}, closed);
}

void MapPicture::speed_line(const std::vector<maps::Point>& points, const std::vector<double>& speeds,
                            double slowest, double fastest, double width, bool closed) {
  const std::size_t n = points.size();
  const double span = std::max(fastest - slowest, 1e-9);
  for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
    const std::size_t next = (i + 1) % n;
    const double speed = 0.5 * (speeds[i] + speeds[next]);
    line({points[i], points[next]}, speed_colour((speed - slowest) / span), width, false);
  }
}

void MapPicture::polygon(const std::vector<maps::Point>& corners, Colour fill, Colour rim) {
  pen_.area(pixels(corners), fill, rim, 2);
}

void MapPicture::disc(const maps::Point& centre, double radius, Colour fill) {
  const maps::Point at = view_.pixel(centre);
  pen_.disc(at.x, at.y, radius, fill, white, 2.5);
}

void MapPicture::cross(const maps::Point& centre, double size, Colour colour) {
  const maps::Point at = view_.pixel(centre);
  for (const auto& [ink_of_line, width] : {std::pair(white, 9.0), std::pair(colour, 4.5)})
    for (const double side : {1.0, -1.0})
      pen_.line(at.x - size, at.y - side * size, at.x + size, at.y + side * size, ink_of_line, width);
}

void MapPicture::arrow(const maps::Pose& at, double size, Colour fill) {
  const maps::Point centre = view_.pixel({at.x, at.y});
  const double along = std::cos(-at.yaw), across = std::sin(-at.yaw);
  Pen::Points corners;
  for (const auto& [x, y] :
       {std::pair{size, 0.0}, {-0.7 * size, 0.75 * size}, {-0.3 * size, 0.0}, {-0.7 * size, -0.75 * size}})
    corners.emplace_back(centre.x + along * x - across * y, centre.y + across * x + along * y);
  pen_.area(corners, fill, white, 2.5);
}

std::vector<std::string> MapPicture::wrapped(const std::string& words, double size, double width) {
  static const std::string separator = " \xC2\xB7 ";
  std::vector<std::string> lines = {""};
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(separator, begin), words.size());
    const std::string part = words.substr(begin, end - begin);
    const std::string longer = lines.back().empty() ? part : lines.back() + separator + part;
    if (lines.back().empty() || pen_.text_width(longer, size) <= width)
      lines.back() = longer;
    else
      lines.push_back(part);
    begin = end + separator.size();
  }
  return lines;
}

double MapPicture::fitting_size(const std::string& words, double size, double least, double width) {
  return std::clamp(size * width / std::max(pen_.text_width(words, size, true), 1.0), least, size);
}

void MapPicture::legend(const std::string& title, const std::string& facts, double slowest, double fastest) {
  const double margin = 36, base = view_.height;
  const double bar_width = 260, bar_left = view_.width - margin - bar_width, bar_top = base + 84;
  // A lap of an evaluation is named by all that was set for it.
  pen_.text(margin, base + 64, fitting_size(title, 40, 14, bar_left - 3 * margin), title, ink, 0, true);

  double size = 22, spacing = 30, first = 100;
  auto lines = wrapped(facts, size, bar_left - 2 * margin);
  if (lines.size() == 1) first = 108;
  if (lines.size() > 2) {  // a narrow picture: three lines fit into the band
    size = 18, spacing = 23, first = 98;
    lines = wrapped(facts, size, bar_left - 2 * margin);
  }
  for (std::size_t i = 0; i < lines.size(); ++i)
    pen_.text(margin, base + first + spacing * static_cast<double>(i), size, lines[i], faint_ink);
  for (int k = 0; k < static_cast<int>(bar_width); ++k) {
    pen_.rectangle(bar_left + k, bar_top, 1.5, 14, speed_colour(k / (bar_width - 1)));
  }
  pen_.text(bar_left, bar_top + 38, 20, formatted("%.1f", slowest), faint_ink);
  pen_.text(bar_left + bar_width, bar_top + 38, 20, formatted("%.1f m/s", fastest), faint_ink, 1);

  scale_bar(bar_width, view_.width - margin, base + 46);
}

void MapPicture::scale_bar(double longest, double right, double at) {
  const double metres = round_length(longest / view_.scale), pixels = metres * view_.scale;
  pen_.path({{right - pixels, at - 8}, {right - pixels, at}, {right, at}, {right, at - 8}}, ink, 3);
  pen_.text(right - pixels - 12, at + 2, 20, formatted(metres < 1 ? "%.1f m" : "%.0f m", metres), faint_ink,
            1);
}

void MapPicture::key(const std::string& title, const std::string& facts,
                     const std::vector<std::pair<std::string, Colour>>& entries) {
  const double margin = 36, base = view_.height;
  pen_.text(margin, base + 56, 36, title, ink, 0, true);
  pen_.text(margin, base + 92, 21, facts, faint_ink);
  double left = margin;
  for (const auto& [words, colour] : entries) {
    pen_.rectangle(left, base + 116, 26, 12, colour);
    pen_.text(left + 36, base + 129, 20, words, ink);
    left += 36 + pen_.text_width(words, 20) + 34;
  }
  scale_bar(260, view_.width - margin, base + 46);
}

}  // namespace slalom::tools
