#include "vehicle/racing/map_corridor.hpp"

#include <cstddef>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "vehicle/course/curve.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr int centring_rounds = 4;
// Lengths over the median half width: the widest that draws the line, so that side rooms do not; deviations
// of smoothing the shifts, and the line itself.
constexpr double centring_reach = 1.5, centring_smooth = 0.5, line_smooth = 0.3;
constexpr double kept_width = 1.2;  // to each side where a line is kept, over the distance from walls

/// Looks along the normals of a line.
struct Rays {
  const FreeSpace& space;
  const Corridor& line;
  const CorridorMeasure& measure;
  double march = 0.5 * space.map().resolution;

  /// The offset nearest to the line where the car can be; nothing within reach is empty.
  std::optional<double> free_offset(std::size_t i) const {
    for (double t = 0; t <= measure.reach; t += march)
      for (const double offset : {t, -t})
        if (free(i, offset)) return offset;
    return std::nullopt;
  }

  /// The furthest offset that the car can have to one side (1 left, -1 right) of a given one.
  double last_offset(std::size_t i, double from, int side) const {
    double good = from;
    while (std::abs(good) < measure.reach && free(i, good + side * march)) good += side * march;
    double bad = good + side * march;
    for (int k = 0; k < 6; ++k) {
      const double middle = 0.5 * (good + bad);
      (free(i, middle) ? good : bad) = middle;
    }
    return good;
  }

  bool free(std::size_t i, double offset) const {
    const maps::Point at = line.centre_line[i] + offset * line.normal[i];
    return space.is_clear(at, measure.keep) && is_nearest(i, offset, at);
  }

  /// Whether no other part of the line nearby is nearer.
  bool is_nearest(std::size_t i, double offset, const maps::Point& at) const {
    const auto n = static_cast<std::ptrdiff_t>(line.centre_line.size());
    const double limit = std::abs(offset) - 0.02 * measure.step;
    if (limit <= 0) return true;
    const auto window =
        std::min<std::ptrdiff_t>(saturate_cast<std::ptrdiff_t>(4 * limit / measure.step) + 2, n / 2);
    for (std::ptrdiff_t k = -window; k <= window; ++k) {
      const std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) + k;
      if (!line.closed && (j < 0 || j >= n)) continue;
      const maps::Point away = at - line.centre_line[(j + n) % n];
      if (dot(away, away) < limit * limit) return false;
    }
    return true;
  }
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Throws std::invalid_argument if less than half of a line is in free space: it is that of another map, in
/// other units, or displaced.
void check_place(const FreeSpace& space, const std::vector<maps::Point>& line) {
  std::size_t free = 0;
  maps::Point low = line[0], high = line[0];
  for (const maps::Point& point : line) {
    free += space.clearance(point) > 0;
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  }
  if (2 * free > line.size()) return;
  const maps::Point from = space.centre(0, 0),
                    to = space.centre(space.map().width - 1, space.map().height - 1);
  char text[300];
  std::snprintf(text, sizeof text,
                "line: %zu of its %zu points are in free space of the map; it reaches from (%.2f, %.2f) to "
                "(%.2f, %.2f), and the map from (%.2f, %.2f) to (%.2f, %.2f)",
                free, line.size(), low.x, low.y, high.x, high.y, from.x, from.y, to.x, to.y);
  throw std::invalid_argument(text);
}

}  // namespace

Corridor measured_corridor(const FreeSpace& space, const std::vector<maps::Point>& line, bool closed,
                           const CorridorMeasure& measure) {
  Corridor corridor{.centre_line = divided_by_step(line, closed, measure.step).points, .closed = closed};
  corridor.normal = normals(corridor.centre_line, closed);
  const Rays rays{space, corridor, measure};
  for (std::size_t i = 0; i < corridor.centre_line.size(); ++i) {
    const bool kept = measure.keeps(space, corridor.centre_line[i]);
    const std::optional<double> begin = kept ? std::nullopt : rays.free_offset(i);
    // A place where the car does not fit closes the corridor.
    const double otherwise = kept ? kept_width * measure.keep : 0;
    corridor.left.push_back(begin ? rays.last_offset(i, *begin, 1) + measure.keep : otherwise);
    corridor.right.push_back(begin ? measure.keep - rays.last_offset(i, *begin, -1) : otherwise);
  }
  return corridor;
}

Corridor centred_corridor(const FreeSpace& space, const std::vector<maps::Point>& line, bool closed,
                          const CorridorMeasure& measure) {
  const auto even = [&](const std::vector<maps::Point>& points) {
    return divided_by_step(points, closed, measure.step).points;
  };
  std::vector<maps::Point> centre = even(line);
  std::vector<double> clearances;
  for (const maps::Point& point : centre)
    clearances.push_back(measure.keeps(space, point) ? measure.keep : space.clearance(point));
  centre = even(smoothed(centre, std::max(measure.keep, centring_smooth * median(clearances)), closed));
  for (int round = 0; round < centring_rounds; ++round) {
    const Corridor now = measured_corridor(space, centre, closed, measure);
    std::vector<double> halves, shift;
    for (std::size_t i = 0; i < now.left.size(); ++i) halves.push_back(0.5 * (now.left[i] + now.right[i]));
    const double half = median(std::move(halves)), most = centring_reach * half;
    for (std::size_t i = 0; i < now.left.size(); ++i)
      shift.push_back(0.5 * (std::min(now.left[i], most) - std::min(now.right[i], most)));
    shift = smoothed(shift, closed, measure.step, centring_smooth * half);
    for (std::size_t i = 0; i < shift.size(); ++i) centre[i] = now.centre_line[i] + shift[i] * now.normal[i];
    centre = even(smoothed(even(centre), line_smooth * half, closed));
  }
  Corridor corridor = measured_corridor(space, centre, closed, measure);
  for (std::size_t i = 0; i < corridor.left.size(); ++i)
    if (!(corridor.left[i] + corridor.right[i] > 0)) check_place(space, line);
  return corridor;
}

}  // namespace slalom::vehicle::detail
