#include "tracking/box_fit.hpp"

#include <algorithm>

namespace slalom::tracking {
namespace {

constexpr int coarse_angles = 30, fine_angles = 6;  // parts of a right angle, and of one of them
constexpr std::size_t max_fitted = 60;              // readings of a fit, evenly taken

struct Range {
  double low, high;
  double length() const { return high - low; }
};

Range range_along(std::span<const Reading> readings, std::size_t every, double x, double y) noexcept {
  Range r{1e300, -1e300};
  for (std::size_t i = 0; i < readings.size(); i += every) {
    const double at = x * readings[i].point.x + y * readings[i].point.y;
    r = {std::min(r.low, at), std::max(r.high, at)};
  }
  return r;
}

/// The sum over readings of 1 / distance to the nearest of the two sides.
double closeness(std::span<const Reading> readings, std::size_t every, double angle, double least) noexcept {
  const double c = std::cos(angle), s = std::sin(angle);
  const Range along = range_along(readings, every, c, s), across = range_along(readings, every, -s, c);
  // Which side of each axis the readings are close to is decided for all of them together (algorithm 4).
  double sums[2][2] = {};
  for (std::size_t i = 0; i < readings.size(); i += every) {
    const maps::Point& p = readings[i].point;
    const double a = c * p.x + s * p.y, b = -s * p.x + c * p.y;
    sums[0][0] += (a - along.low) * (a - along.low);
    sums[0][1] += (along.high - a) * (along.high - a);
    sums[1][0] += (b - across.low) * (b - across.low);
    sums[1][1] += (across.high - b) * (across.high - b);
  }
  double sum = 0;
  for (std::size_t i = 0; i < readings.size(); i += every) {
    const maps::Point& p = readings[i].point;
    const double a = c * p.x + s * p.y, b = -s * p.x + c * p.y;
    const double from_along = sums[0][0] < sums[0][1] ? a - along.low : along.high - a;
    const double from_across = sums[1][0] < sums[1][1] ? b - across.low : across.high - b;
    sum += 1 / std::max(std::min(from_along, from_across), least);
  }
  return sum;
}

/// The readings at one end along an axis.
struct End {
  double at = 0;         ///< m
  bool in_view = false;  ///< the object ends there
  bool side = false;     ///< a side of the box, on which several readings lie
};

/// Finds the low end of readings in the coordinate `along` (the high end where `sign` is -1).
template <class Along, class Across>
End find_end(std::size_t count, double sign, double deviation, const Along& along, const Across& across,
             bool first_ends, bool last_ends) noexcept {
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (sign * along(i) < sign * along(lowest)) lowest = i;
  const double low = sign * along(lowest), window = 4 * deviation;
  double sum = 0, least = 1e300, most = -1e300;
  int near = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (sign * along(i) > low + window) continue;
    sum += sign * along(i);
    least = std::min(least, across(i));
    most = std::max(most, across(i));
    ++near;
  }
  End end{.side = near >= 3 && most - least > 2 * window};
  end.in_view = end.side || (lowest == 0 ? first_ends : lowest == count - 1 ? last_ends : true);
  end.at = sign * (end.side ? sum / near : low);
  return end;
}

}  // namespace

BoxFit fit_box(std::span<const Reading> readings, double deviation) noexcept {
  const std::size_t every = (readings.size() + max_fitted - 1) / max_fitted;
  double best = 0, most = -1;
  const auto attempt = [&](double angle) {
    const double score = closeness(readings, every, angle, deviation);
    if (score <= most) return;
    most = score;
    best = angle;
  };
  for (int i = 0; i < coarse_angles; ++i) attempt(i * right_angle / coarse_angles);
  const double middle = best;
  for (int i = -fine_angles + 1; i < fine_angles; ++i)
    attempt(middle + i * right_angle / coarse_angles / fine_angles);
  BoxFit fit{.angle = best - right_angle * std::floor(best / right_angle)};
  const double c = std::cos(fit.angle), s = std::sin(fit.angle);
  fit.extent[0] = range_along(readings, 1, c, s).length();
  fit.extent[1] = range_along(readings, 1, -s, c).length();
  // The slope of a line through n readings evenly over its length has the variance 12 sigma^2 / (n length^2).
  const double longest = std::max({fit.extent[0], fit.extent[1], deviation});
  fit.angle_deviation = std::sqrt(12 / static_cast<double>(readings.size())) * deviation / longest;
  return fit;
}

void measure_box(const BoxPrior& prior, const Readings& scan, std::span<const Reading> readings,
                 double min_incidence, double deviation, AxisMeasurement (&axes)[2]) noexcept {
  const double c = std::cos(prior.pose.yaw), s = std::sin(prior.pose.yaw);
  const auto coordinate = [&](int axis) {
    const double x = axis == 0 ? c : -s, y = axis == 0 ? s : c;
    return
        [&prior, x, y](const maps::Point& p) { return x * (p.x - prior.pose.x) + y * (p.y - prior.pose.y); };
  };
  const std::size_t count = readings.size();
  const bool first_ends = scan.ends_at(readings.front().beam, -1, min_incidence, deviation),
             last_ends = scan.ends_at(readings.back().beam, 1, min_incidence, deviation);
  // An object whose outline ends with nothing beside it reaches half a beam farther than its last reading.
  const double beam = 0.5 * readings[count / 2].range * scan.increment();
  for (int axis = 0; axis < 2; ++axis) {
    const auto own = coordinate(axis), other = coordinate(1 - axis);
    const auto along = [&](std::size_t i) { return own(readings[i].point); };
    const auto across = [&](std::size_t i) { return other(readings[i].point); };
    End low = find_end(count, 1, deviation, along, across, first_ends, last_ends);
    End high = find_end(count, -1, deviation, along, across, first_ends, last_ends);
    if (!low.side) low.at -= beam;
    if (!high.side) high.at += beam;
    const double half = 0.5 * prior.size[axis];
    AxisMeasurement& m = axes[axis];
    const double reading = deviation * deviation / 2 + beam * beam / 3 + 1e-4;  // variance of an end
    const double anchored = reading + 0.25 * prior.size_deviation * prior.size_deviation;
    const bool both = low.in_view && high.in_view;
    // If the box is to one side of the sensor, its near end counts alone: the far one is hidden.
    const double view = own({scan.sensor().x, scan.sensor().y});
    const bool from_low = view + half<0, from_high = view - half> 0;
    if (low.in_view && (from_low || (!high.in_view && !from_high))) {
      m = {low.at + half, anchored, 0};
    } else if (high.in_view && (from_high || (!low.in_view && !from_low))) {
      m = {high.at - half, anchored, 0};
    } else if (both) {
      m = {0.5 * (low.at + high.at), reading, 0};
    } else {
      // The box covers the readings; nothing more is known.
      const double slack = std::max(0.0, half - 0.5 * (high.at - low.at));
      const double middle = 0.5 * (low.at + high.at);
      m = {std::clamp(0.0, middle - slack, middle + slack), reading + slack * slack, 0};
    }
    if (both && high.at - low.at > 0.5 * prior.size[axis]) m.size = high.at - low.at;
  }
}

}  // namespace slalom::tracking
