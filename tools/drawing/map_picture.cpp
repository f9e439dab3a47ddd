#include "tools/drawing/map_picture.hpp"
#include "tools/command_line/words.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

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

MapView view_of(const maps::OccupancyGrid& map, int long_side) {
  const double along = map.width * map.resolution, across = map.height * map.resolution;
  double left = map.origin.x, right = left, low = map.origin.y, top = low;
  for (const maps::Point& corner : {maps::Point{along, 0}, {along, across}, {0, across}}) {
    const maps::Point at = maps::transform(map.origin, corner);
    left = std::min(left, at.x);
    right = std::max(right, at.x);
    low = std::min(low, at.y);
    top = std::max(top, at.y);
  }
  const double wide = right - left, high = top - low;
  MapView view;
  view.scale = long_side / std::max(wide, high);
  view.height = static_cast<int>(std::ceil(high * view.scale - 1e-6));
  view.width = std::max(static_cast<int>(std::ceil(wide * view.scale - 1e-6)), 900);
  view.left = left - 0.5 * (view.width / view.scale - wide);
  view.top = top;
  return view;
}

}  // namespace

MapPicture::MapPicture(const maps::OccupancyGrid& map, int long_side)
    : view_(view_of(map, long_side)), canvas_(view_.width, view_.height + band) {
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
