#include "slalom/sim/racing_line.hpp"

#include <algorithm>

#include "slalom/core/numbers/count.hpp"
#include "slalom/core/options.hpp"

namespace slalom::sim {
namespace {

constexpr double usual_spacing = 0.2;                      // m, of samples
constexpr double wall_margin = 0.1, parked_margin = 0.12;  // m
constexpr double lateral = 6, longitudinal = 5;            // m/s^2, limits of the accelerations
constexpr int lanes_aside = 40, lanes = 2 * lanes_aside + 1;
constexpr double lane_step = 0.05;                    // m, from one lane to the next: 0.25 of the spacing
constexpr double offset_cost = 0.1, change_cost = 1;  // costs of 1 m^2 for a sample, and of a change of lane
constexpr double inflation = 0.05;                    // m, of a body that is turned while it moves aside
constexpr double curvature_reach = 0.4;               // m to either side, over which it is measured
constexpr int smoothing = 3;                          // samples to either side

std::vector<maps::Point> points_of(std::span<const PathPoint> path) {
  std::vector<maps::Point> points;
  for (const PathPoint& each : path) {
    slalom::detail::check("racing line", {"speed", "m/s", "", -1e9, 1e9}, each.speed);
    points.push_back(each.point);
  }
  return points;
}

/// Samples of the path at equal distances.
std::vector<maps::Point> resampled(const LapPath& path) {
  slalom::count(path.length(), usual_spacing, 1e6, "racing line");
  const auto count = std::max<std::size_t>(8, saturate_cast<std::size_t>(path.length() / usual_spacing));
  std::vector<maps::Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    const maps::Pose pose = path.at(path.length() * i / count);
    points.push_back({pose.x, pose.y});
  }
  return points;
}

/// The profile of the path at a pose along it.
double speed_at(std::span<const PathPoint> path, const LapPath& measured, const maps::Pose& pose) {
  const LapPath::Place place = measured.project(pose);
  const PathPoint &a = path[place.segment], &b = path[(place.segment + 1) % path.size()];
  const double length = std::hypot(b.point.x - a.point.x, b.point.y - a.point.y);
  const double begin = std::hypot(pose.x - a.point.x, pose.y - a.point.y);
  const double share = length > 0 ? std::clamp(begin / length, 0.0, 1.0) : 0;
  return a.speed + share * (b.speed - a.speed);
}

double half_diagonal(const Box& box) {
  return 0.5 * std::hypot(box.length, box.width);
}

}  // namespace

RacingLine::RacingLine(std::span<const PathPoint> path, const Track& track, const CarParameters& car,
                       std::span<const Box> parked)
    : path_(resampled(LapPath(points_of(path)))) {
  const LapPath given(points_of(path));
  const std::size_t count = path_.size();
  spacing_ = path_.length() / count;
  for (std::size_t i = 0; i < count; ++i) {
    const double arc = spacing_ * i;
    const maps::Pose before = path_.at(arc - spacing_), after = path_.at(arc + spacing_);
    const maps::Point here = path_.points()[i];
    const double yaw = std::atan2(after.y - before.y, after.x - before.x);
    points_.push_back({.point = here, .yaw = yaw, .speed = speed_at(path, given, {here.x, here.y, yaw})});
  }
  for (const double share : {1.0, 0.6, 0.3, 0.0}) {
    const auto free = free_cells(track, car, parked, share * wall_margin, share * parked_margin);
    if (!find_way(free)) continue;
    find_room(free);
    break;
  }
  smooth();
  limit_speeds();
}

/// Whether a car may be there, [sample][lane].
std::vector<std::uint8_t> RacingLine::free_cells(const Track& track, const CarParameters& car,
                                                 std::span<const Box> parked, double to_walls,
                                                 double to_parked) const {
  std::vector<std::uint8_t> free(points_.size() * lanes);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& at = points_[i];
    const auto is_free = [&](const maps::Point& middle) {
      if (track.distance_to_wall(middle) < 0.5 * car.width + to_walls) return false;
      const Box body{{middle.x, middle.y, at.yaw}, car.length, car.width + 2 * inflation};
      return std::none_of(parked.begin(), parked.end(), [&](const Box& other) {
        const double reach = half_diagonal(body) + half_diagonal(other) + to_parked;
        return std::hypot(other.pose.x - middle.x, other.pose.y - middle.y) < reach &&
               signed_gap(body, other) < to_parked;
      });
    };
    // Beyond a wall there may be another road.
    for (const int side : {-1, 1})
      for (int lane = lanes_aside; lane >= 0 && lane < lanes; lane += side) {
        const maps::Point middle = at.beside(lane_step * (lane - lanes_aside));
        if (track.in_wall(middle)) break;
        free[i * lanes + lane] = is_free(middle);
      }
  }
  return free;
}

/// Sets the offsets of the cheapest way (Viterbi). It goes round three times and keeps the second, which
/// begins and ends as the others do. False if there is none.
bool RacingLine::find_way(std::span<const std::uint8_t> free) {
  constexpr double closed = std::numeric_limits<double>::infinity();
  const std::size_t count = points_.size(), rows = 3 * count;
  std::vector<double> costs(lanes, 0), next(lanes);
  std::vector<std::int8_t> moves(rows * lanes);
  for (std::size_t row = 0; row < rows; ++row) {
    for (int lane = 0; lane < lanes; ++lane) {
      double best = closed;
      int move = 0;
      for (const int from : {0, -1, 1}) {
        if (lane + from < 0 || lane + from >= lanes) continue;
        const double cost = costs[lane + from] + change_cost * std::abs(from) * lane_step;
        if (cost < best) best = cost, move = from;
      }
      const double offset = lane_step * (lane - lanes_aside);
      const auto cell = (row % count) * lanes + lane;
      next[lane] = free[cell] ? best + offset_cost * offset * offset : closed;
      moves[row * lanes + lane] = static_cast<std::int8_t>(move);
    }
    costs.swap(next);
  }
  const auto end = std::min_element(costs.begin(), costs.end());
  if (*end == closed) return false;
  int lane = static_cast<int>(end - costs.begin());
  for (std::size_t row = rows; row-- > count;) {
    if (row < 2 * count) points_[row % count].offset = lane_step * (lane - lanes_aside);
    lane += moves[row * lanes + lane];
  }
  return true;
}

/// Sets the offsets around the line that are free, and that a car reaches in time by the same slope.
void RacingLine::find_room(std::span<const std::uint8_t> free) {
  const std::size_t count = points_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const int lane = saturate_cast<int>(std::round(points_[i].offset / lane_step)) + lanes_aside;
    int first = lane, last = lane;
    while (first > 0 && free[i * lanes + first - 1]) --first;
    while (last + 1 < lanes && free[i * lanes + last + 1]) ++last;
    points_[i].least = lane_step * (first - lanes_aside);
    points_[i].most = lane_step * (last - lanes_aside);
  }
  const auto limit = [&](std::size_t at, std::size_t by) {
    Point &point = points_[at % count], &other = points_[by % count];
    point.least = std::max(point.least, other.least - lane_step);
    point.most = std::min(point.most, other.most + lane_step);
  };
  for (std::size_t i = 0; i < 2 * count; ++i) limit(i + 1, i);
  for (std::size_t i = 2 * count; i > 0; --i) limit(i - 1, i);
  for (Point& point : points_)
    if (point.least > point.most) point.least = point.most = point.offset;
}

/// The line without the corners of lanes, within its room.
void RacingLine::smooth() {
  const std::vector<Point> before = points_;
  const std::size_t count = points_.size();
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0;
    for (int k = -smoothing; k <= smoothing; ++k) sum += before[(i + count + k) % count].offset;
    points_[i].offset = std::clamp(sum / (2 * smoothing + 1), points_[i].least, points_[i].most);
  }
}

/// Lowers the speeds to the limits of the accelerations.
void RacingLine::limit_speeds() {
  std::vector<maps::Point> line;
  for (const Point& each : points_) line.push_back(each.beside(each.offset));
  const LapPath measured(line);
  const std::size_t count = points_.size();
  double arc = 0;
  std::vector<double> way;
  for (std::size_t i = 0; i < count; ++i) {
    const maps::Point &a = line[i], &b = line[(i + 1) % count];
    const maps::Pose before = measured.at(arc - curvature_reach), here = measured.at(arc),
                     after = measured.at(arc + curvature_reach);
    const double turned = maps::wrap_angle(std::atan2(after.y - here.y, after.x - here.x) -
                                           std::atan2(here.y - before.y, here.x - before.x));
    const double curvature = std::abs(turned) / curvature_reach;
    points_[i].speed = std::min(points_[i].speed, std::sqrt(lateral / std::max(curvature, 1e-6)));
    way.push_back(std::hypot(b.x - a.x, b.y - a.y));
    arc += way.back();
  }
  const auto reached = [&](double from, double length) {
    return std::sqrt(from * from + 2 * longitudinal * length);
  };
  for (std::size_t i = 2 * count; i > 0; --i) {
    Point& here = points_[(i - 1) % count];
    here.speed = std::min(here.speed, reached(points_[i % count].speed, way[(i - 1) % count]));
  }
  for (std::size_t i = 0; i < 2 * count; ++i) {
    Point& there = points_[(i + 1) % count];
    there.speed = std::min(there.speed, reached(points_[i % count].speed, way[i % count]));
  }
}

maps::Point RacingLine::Point::beside(double left) const noexcept {
  return {point.x - left * std::sin(yaw), point.y + left * std::cos(yaw)};
}

RacingLine::Point RacingLine::at(double arc) const noexcept {
  const double turns = arc / path_.length();
  const double place = (turns - std::floor(turns)) * points_.size();
  const auto first = std::min(saturate_cast<std::size_t>(place), points_.size() - 1);
  const double share = std::clamp(place - static_cast<double>(first), 0.0, 1.0);
  const Point &a = points_[first], &b = points_[(first + 1) % points_.size()];
  const auto mix = [share](double from, double to) { return from + share * (to - from); };
  return {.point = {mix(a.point.x, b.point.x), mix(a.point.y, b.point.y)},
          .yaw = a.yaw + share * maps::wrap_angle(b.yaw - a.yaw),
          .speed = mix(a.speed, b.speed),
          .offset = mix(a.offset, b.offset),
          .least = mix(a.least, b.least),
          .most = mix(a.most, b.most)};
}

double RacingLine::between(double from, double to) const noexcept {
  const double turns = (to - from) / path_.length() + 0.5;
  return path_.length() * (turns - std::floor(turns) - 0.5);
}

}  // namespace slalom::sim
