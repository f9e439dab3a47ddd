#include "vehicle/racing/map_corridor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "vehicle/course/curve.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr int centring_rounds = 4;
// Lengths over the median half width: the widest that draws the line, so that side rooms do not; deviations
// of smoothing the shifts, and the line itself.
constexpr double centring_reach = 1.5, centring_smooth = 0.5, line_smooth = 0.3;

/// Looks along the normals of a line.
class Rays {
 public:
  Rays(const FreeSpace& space, const std::vector<maps::Point>& line, bool closed,
       const CorridorMeasure& measure)
      : space_(space),
        line_(line),
        normals_(detail::normals(line, closed)),
        closed_(closed),
        measure_(measure),
        march_(0.5 * space.map().resolution) {}

  const std::vector<maps::Point>& normals() const { return normals_; }

  /// The offset nearest to the line where the car can be; nothing within reach is empty.
  std::optional<double> free_offset(std::size_t i) const {
    for (double t = 0; t <= measure_.reach; t += march_)
      for (const double offset : {t, -t})
        if (free(i, offset)) return offset;
    return std::nullopt;
  }

  /// The furthest offset that the car can have to one side (1 left, -1 right) of a given one.
  double last_offset(std::size_t i, double from, int side) const {
    double good = from;
    while (std::abs(good) < measure_.reach && free(i, good + side * march_)) good += side * march_;
    double bad = good + side * march_;
    for (int k = 0; k < 6; ++k) {
      const double middle = 0.5 * (good + bad);
      (free(i, middle) ? good : bad) = middle;
    }
    return good;
  }

 private:
  bool free(std::size_t i, double offset) const {
    const maps::Point at{line_[i].x + offset * normals_[i].x, line_[i].y + offset * normals_[i].y};
    return space_.is_clear(at, measure_.keep) && is_nearest(i, offset, at);
  }

  /// Whether no other part of the line nearby is nearer.
  bool is_nearest(std::size_t i, double offset, const maps::Point& at) const {
    const auto n = static_cast<std::ptrdiff_t>(line_.size());
    const double limit = std::abs(offset) - 0.02 * measure_.step;
    if (limit <= 0) return true;
    const auto window =
        std::min<std::ptrdiff_t>(saturate_cast<std::ptrdiff_t>(4 * limit / measure_.step) + 2, n / 2);
    for (std::ptrdiff_t k = -window; k <= window; ++k) {
      std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) + k;
      if (!closed_ && (j < 0 || j >= n)) continue;
      j = (j + n) % n;
      const maps::Point& other = line_[j];
      const double dx = at.x - other.x, dy = at.y - other.y;
      if (dx * dx + dy * dy < limit * limit) return false;
    }
    return true;
  }

  const FreeSpace& space_;
  const std::vector<maps::Point>& line_;
  std::vector<maps::Point> normals_;
  bool closed_;
  CorridorMeasure measure_;
  double march_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_half_width(const Corridor& corridor) {
  std::vector<double> halves;
  for (std::size_t i = 0; i < corridor.left.size(); ++i)
    halves.push_back(0.5 * (corridor.left[i] + corridor.right[i]));
  return median(halves);
}

}  // namespace

Corridor measured_corridor(const FreeSpace& space, const std::vector<maps::Point>& line, bool closed,
                           const CorridorMeasure& measure) {
  Corridor corridor;
  corridor.closed = closed;
  corridor.centre_line = divided_by_step(line, closed, measure.step).points;
  const Rays rays(space, corridor.centre_line, closed, measure);
  corridor.normal = rays.normals();
  for (std::size_t i = 0; i < corridor.centre_line.size(); ++i) {
    const std::optional<double> begin = rays.free_offset(i);
    // A place where the car does not fit closes the corridor.
    corridor.left.push_back(begin ? rays.last_offset(i, *begin, 1) + measure.keep : 0);
    corridor.right.push_back(begin ? measure.keep - rays.last_offset(i, *begin, -1) : 0);
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
  for (const maps::Point& point : centre) clearances.push_back(space.clearance(point));
  centre = even(smoothed(centre, std::max(measure.keep, centring_smooth * median(clearances)), closed));
  for (int round = 0; round < centring_rounds; ++round) {
    const Corridor now = measured_corridor(space, centre, closed, measure);
    const double half = median_half_width(now), most = centring_reach * half;
    std::vector<double> shift;
    for (std::size_t i = 0; i < now.left.size(); ++i)
      shift.push_back(0.5 * (std::min(now.left[i], most) - std::min(now.right[i], most)));
    shift = smoothed(shift, closed, measure.step, centring_smooth * half);
    for (std::size_t i = 0; i < shift.size(); ++i) centre[i] = now.centre_line[i] + shift[i] * now.normal[i];
    centre = even(smoothed(even(centre), line_smooth * half, closed));
  }
  return measured_corridor(space, centre, closed, measure);
}

}  // namespace slalom::vehicle::detail
