#include "slalom/vehicle/racing/race_course.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/image.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "vehicle/course/track_parts.hpp"
#include "vehicle/racing/free_space.hpp"
#include "vehicle/racing/loop_search.hpp"
#include "vehicle/racing/map_corridor.hpp"

namespace slalom::vehicle {
namespace {

constexpr double widest = 25;              // reach of a corridor to one side, in half widths of the car
constexpr double max_line_points = 3000;   // points of a centre line
constexpr int max_rounds = 4;              // rounds of improving a line along its own normals
constexpr double min_gain = 5e-4;          // share of the time, by which a round must improve it
constexpr double min_room = 1e-3;          // m, between the bounds of a line
constexpr double max_yaw = 0.6;            // rad, of the way from the x axis at a start that is found
constexpr double most_cells = 2.5e7;       // cells of a map that is drawn
constexpr double most_drawn = 3e8;         // cells that are visited to draw it
constexpr double most_cells_of_car = 200;  // cells of a map across the car
constexpr double run_out = 5;              // m beyond the ends of an open course, in widths of the car
constexpr double half_turn = 3.14159265358979323846;  // rad

std::string text_of(const maps::Point& point) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f)", point.x, point.y);
  return text;
}

template <class Points>
std::size_t nearest_row(const Points& points, const maps::Point& place) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (distance({points[i].x, points[i].y}, place) < distance({points[best].x, points[best].y}, place))
      best = i;
  return best;
}

/// The cosine of the angle between a pose and the line where it is nearest.
double along(const std::vector<maps::Point>& line, bool closed, const maps::Pose& pose) {
  const std::size_t n = line.size(), at = nearest_row(line, {pose.x, pose.y});
  const auto row = [&](std::size_t reach, bool ahead) {
    if (closed) return ahead ? (at + reach) % n : (at + n - reach) % n;
    return ahead ? std::min(at + reach, n - 1) : at - std::min(at, reach);
  };
  // A line of cells has eight directions from cell to cell.
  const std::size_t reach = std::min<std::size_t>(5, n / 4);
  const maps::Point &before = line[row(reach, false)], &after = line[row(reach, true)];
  return ((after.x - before.x) * std::cos(pose.yaw) + (after.y - before.y) * std::sin(pose.yaw)) /
         distance(before, after);
}

/// Makes a row of a closed line the first one.
template <class Values>
void begin_at(Values& values, std::size_t first) {
  std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first), values.end());
}

/// Makes raceline and corridor begin at the start, or in the middle of the raceline's fastest part.
void begin_at_start(RaceCourse& course, const std::optional<maps::Pose>& start) {
  auto& points = course.raceline.points;
  if (course.raceline.closed) {
    std::vector<double> speeds;
    for (const RacelinePoint& point : points) speeds.push_back(point.speed);
    const std::size_t first = start ? nearest_row(points, {start->x, start->y}) : detail::start_row(speeds);
    const double before = points[first].arc_length;
    const double length = course.raceline.length;
    begin_at(points, first);
    for (RacelinePoint& point : points)
      point.arc_length = std::fmod(point.arc_length - before + length, length);
    points.front().arc_length = 0;
    Corridor& corridor = course.corridor;
    const std::size_t row = nearest_row(corridor.centre_line, {points.front().x, points.front().y});
    begin_at(corridor.centre_line, row);
    begin_at(corridor.normal, row);
    begin_at(corridor.left, row);
    begin_at(corridor.right, row);
  }
  course.start = start.value_or(maps::Pose{points.front().x, points.front().y, points.front().yaw});
}

/// The fastest line. Beside tight bends the normals of the centre line meet before the wall; those of the
/// line itself reach farther, so that it is improved along its own normals.
Raceline fastest_line(const detail::FreeSpace& space, const Corridor& corridor, const RacingCar& car,
                      const detail::CorridorMeasure& measure) {
  Raceline best = minimum_time_raceline(corridor, car);
  for (int round = 0; round < max_rounds; ++round) {
    std::vector<maps::Point> line;
    for (const RacelinePoint& point : best.points) line.push_back({point.x, point.y});
    const Corridor along_line = detail::measured_corridor(space, line, best.closed, measure);
    for (std::size_t i = 0; i < along_line.left.size(); ++i)
      if (along_line.left[i] + along_line.right[i] <= 2 * measure.keep + min_room) return best;
    Raceline next = minimum_time_raceline(along_line, car);
    const bool turns_more = next.curvature_limit > best.curvature_limit;
    if (turns_more || next.time >= best.time) return best;
    const bool done = next.time > (1 - min_gain) * best.time;
    best = std::move(next);
    if (done) return best;
  }
  return best;
}

/// Raceline, start and notes from map and corridor.
void complete(RaceCourse& course, const detail::FreeSpace& space, const RacingCar& car,
              const detail::CorridorMeasure& measure, const std::optional<maps::Pose>& start) {
  course.raceline = fastest_line(space, course.corridor, car, measure);
  begin_at_start(course, start);
  for (const RacelinePoint& point : course.raceline.points)
    course.distance.push_back(space.clearance(maps::Point{point.x, point.y}));
  if (course.raceline.curvature_limit > max_curvature(car)) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "the corridor forces the line to a curvature of %.3g 1/m; the steering of the car reaches %.3g 1/m",
        course.raceline.curvature_limit, max_curvature(car));
    course.notes.emplace_back(text);
  }
}

/// The measures of a corridor for a course of this length (m).
detail::CorridorMeasure measure_for(const RacingCar& car, double length) {
  return {least_wall_distance(car), centre_line_step(car, length), 0.5 * widest * car.width};
}

/// The start that is given.
std::optional<maps::Pose> given_start(const RaceCourseOptions& options, const detail::FreeSpace& space,
                                      double keep) {
  if (!options.start) return std::nullopt;
  const maps::Point at{options.start->x, options.start->y};
  if (!(space.clearance(at) >= 0.5 * keep))
    throw std::invalid_argument("start: " + text_of(at) + " must be in free space of the map");
  return options.start;
}

/// The loop that passes the start. Without a start, the origin of the map frame becomes it if the loop passes
/// there about along its x axis.
std::vector<maps::Point> found_loop(const detail::FreeSpace& space, double keep,
                                    std::optional<maps::Pose>& start, std::vector<std::string>& notes) {
  const auto near = start ? std::optional(maps::Point{start->x, start->y}) : std::nullopt;
  std::vector<maps::Point> line = detail::find_loop(space, keep, near);
  if (line.empty()) {
    char text[200];
    std::snprintf(text, sizeof text, "map: no closed way%s keeps %.3f m from all walls%s",
                  start ? (" that passes the start " + text_of({start->x, start->y})).c_str() : "", keep,
                  start ? "" : "; an open course needs a line to drive along");
    throw std::invalid_argument(text);
  }
  const maps::Point &origin{0, 0}, &passed = line[nearest_row(line, origin)];
  if (!start && space.clearance(origin) >= keep && distance(passed, origin) <= 2 * space.clearance(passed) &&
      std::abs(along(line, true, {})) > std::cos(max_yaw)) {
    start = maps::Pose{};
    notes.emplace_back("the start is the origin of the map frame, along +x, since none was given");
  }
  return line;
}

void check(const RaceCourseOptions& options, const RacingCar& car) {
  validate(car);
  if (options.reverse && options.start)
    throw std::invalid_argument("reverse: must not be set with a start pose, which sets the direction");
}

void check(const GuideLine& guide, const RacingCar& car) {
  if (guide.points.size() < 4)
    throw std::invalid_argument("line: " + std::to_string(guide.points.size()) +
                                " points; at least 4 are needed");
  maps::check_points("line", guide.points);
  if (const double length = detail::length(guide.points, guide.closed); !(length >= car.wheelbase))
    throw std::invalid_argument("line: " + to_text(length) + " m long; must be at least " +
                                to_text(car.wheelbase) + " m, the wheelbase of the car");
}

/// The size of the cells (m) of a drawn map: as given, or larger if it would have more than `most_cells`.
double drawn_resolution(double length_x, double length_y, double resolution) {
  const double side = std::max(length_x, length_y) / (maps::max_image_side - 8);
  return std::max({resolution, std::sqrt(length_x * length_y / most_cells), side});
}

/// Throws std::invalid_argument if a corridor, whose line needs a map of this size (m), is so wide for its
/// length that a map of it takes too long.
void check_work(const Corridor& corridor, double length_x, double length_y, double reach, double wall,
                double resolution) {
  const double points = static_cast<double>(corridor.centre_line.size());
  const auto takes_too_long = [&](double side) {
    const double around = 2 * (side + wall),
                 cell = drawn_resolution(length_x + around, length_y + around, resolution);
    const double cells = length(corridor) / points / cell + 2 * (side / cell + std::max(wall / cell, 2.0));
    return points * cells * cells > most_drawn;
  };
  if (!takes_too_long(reach)) return;
  double most = 0, too_much = reach;
  while (too_much - most > 0.01 * too_much) {
    const double middle = 0.5 * (most + too_much);
    (takes_too_long(middle) ? too_much : most) = middle;
  }
  throw std::invalid_argument("corridor: walls " + to_text(std::round(reach)) +
                              " m from the centre line; must be at most " + to_text(std::floor(most)) +
                              " m from it, to be drawn");
}

/// Throws std::invalid_argument if cells that became larger than `wanted` (m) cannot show a corridor.
void check_cells(const Corridor& corridor, double wanted, double resolution) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corridor.left.size(); ++i)
    narrowest = std::min(narrowest, corridor.left[i] + corridor.right[i]);
  if (resolution > wanted && narrowest < 2 * resolution)
    throw std::invalid_argument("corridor: " + to_text(narrowest) + " m wide; must be at least " +
                                to_text(std::ceil(2 * resolution)) +
                                " m, two cells of a map of 25 million cells for its length");
}

/// The corridor of an open course with room to stop: straight on by `length` (m) beyond both ends.
Corridor with_run_outs(Corridor corridor, double length) {
  if (corridor.closed) return corridor;
  auto& line = corridor.centre_line;
  const auto beyond = [&](const maps::Point& end, const maps::Point& before) {
    const double share = length / distance(before, end);
    return maps::Point{end.x + share * (end.x - before.x), end.y + share * (end.y - before.y)};
  };
  const maps::Point first = beyond(line.front(), line[1]), last = beyond(line.back(), line[line.size() - 2]);
  line.insert(line.begin(), first);
  line.push_back(last);
  for (auto* widths : {&corridor.left, &corridor.right}) {
    widths->insert(widths->begin(), widths->front());
    widths->push_back(widths->back());
  }
  return corridor;
}

}  // namespace

double centre_line_step(const RacingCar& car, double length) {
  return std::max(0.5 * car.wheelbase, length / max_line_points);
}

RaceCourse race_course(const maps::OccupancyGrid& map, const RacingCar& car, const RaceCourseOptions& options,
                       const GuideLine* guide) {
  check(options, car);
  if (guide) check(*guide, car);
  count(car.width, map.resolution, most_cells_of_car, "map: the width of the car");
  RaceCourse course;
  course.map = map;
  const double keep = least_wall_distance(car);
  const detail::FreeSpace space(map, car.width);
  if (space.spots() > 0)
    course.notes.push_back(std::to_string(space.spots()) +
                           " unknown spots smaller than the car count as free");
  std::optional<maps::Pose> start = given_start(options, space, keep);
  std::vector<maps::Point> line = guide ? guide->points : found_loop(space, keep, start, course.notes);
  const bool closed = !guide || guide->closed;
  if (start && along(line, closed, *start) < 0) std::reverse(line.begin(), line.end());
  if (options.reverse) std::reverse(line.begin(), line.end());
  if (options.reverse && start) start->yaw = maps::wrap_angle(start->yaw + half_turn);
  const auto measure = measure_for(car, detail::length(line, closed));
  course.corridor = detail::centred_corridor(space, line, closed, measure);
  complete(course, space, car, measure, start);
  return course;
}

RaceCourse race_course(const Corridor& corridor, const RacingCar& car, const RaceCourseOptions& options) {
  check(options, car);
  RaceCourse course;
  course.corridor = corridor;
  const bool backwards =
      (options.start && along(corridor.centre_line, corridor.closed, *options.start) < 0) != options.reverse;
  if (backwards) {
    Corridor& turned = course.corridor;
    std::reverse(turned.centre_line.begin(), turned.centre_line.end());
    std::reverse(turned.normal.begin(), turned.normal.end());
    std::reverse(turned.left.begin(), turned.left.end());
    std::reverse(turned.right.begin(), turned.right.end());
    std::swap(turned.left, turned.right);
    for (maps::Point& normal : turned.normal) normal = {-normal.x, -normal.y};
  }
  course.map =
      draw_corridor(with_run_outs(corridor, run_out * car.width), 0.16 * car.width, 0.64 * car.width);
  check_walls(corridor);
  const detail::FreeSpace space(course.map, 0);
  complete(course, space, car, measure_for(car, length(corridor)), options.start);
  return course;
}

maps::OccupancyGrid draw_corridor(const Corridor& corridor, double resolution, double wall) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto& line = corridor.centre_line;
  double low_x = infinity, low_y = infinity, high_x = -infinity, high_y = -infinity, reach = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    low_x = std::min(low_x, line[i].x);
    low_y = std::min(low_y, line[i].y);
    high_x = std::max(high_x, line[i].x);
    high_y = std::max(high_y, line[i].y);
    reach = std::max({reach, corridor.left[i], corridor.right[i]});
  }
  check_work(corridor, high_x - low_x, high_y - low_y, reach, wall, resolution);
  maps::OccupancyGrid map;
  map.resolution =
      drawn_resolution(high_x - low_x + 2 * (reach + wall), high_y - low_y + 2 * (reach + wall), resolution);
  wall = std::max(wall, 2 * map.resolution);
  check_cells(corridor, resolution, map.resolution);
  reach += wall;
  const auto below = [&](double value) {
    return map.resolution * std::floor((value - reach) / map.resolution - 2);
  };
  map.origin = {below(low_x), below(low_y), 0};
  const auto cells = [&](double high, double first) {
    return count(high + reach - first, map.resolution, maps::max_image_side - 2, "corridor: its map") + 2;
  };
  map.width = static_cast<int>(cells(high_x, map.origin.x));
  map.height = static_cast<int>(cells(high_y, map.origin.y));
  const std::size_t segments = corridor.closed ? line.size() : line.size() - 1;
  std::vector<double> beyond(static_cast<std::size_t>(map.width) * map.height, infinity);
  for (std::size_t i = 0; i < segments; ++i) {
    const std::size_t next = (i + 1) % line.size();
    const maps::Point a = line[i], d{line[next].x - a.x, line[next].y - a.y};
    const double square = d.x * d.x + d.y * d.y;
    const auto cell = [&](double value, double origin) {
      return saturate_cast<int>(std::floor((value - origin) / map.resolution));
    };
    const int x0 = cell(std::min(a.x, a.x + d.x) - reach, map.origin.x),
              x1 = cell(std::max(a.x, a.x + d.x) + reach, map.origin.x),
              y0 = cell(std::min(a.y, a.y + d.y) - reach, map.origin.y),
              y1 = cell(std::max(a.y, a.y + d.y) + reach, map.origin.y);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double px = map.origin.x + (x + 0.5) * map.resolution - a.x,
                     py = map.origin.y + (y + 0.5) * map.resolution - a.y;
        const double t = std::clamp((px * d.x + py * d.y) / square, 0.0, 1.0);
        const auto& widths = d.x * py - d.y * px > 0 ? corridor.left : corridor.right;
        double& least = beyond[static_cast<std::size_t>(y) * map.width + x];
        least = std::min(least,
                         std::hypot(px - t * d.x, py - t * d.y) - ((1 - t) * widths[i] + t * widths[next]));
      }
  }
  map.cells.reserve(beyond.size());
  for (const double b : beyond)
    map.cells.push_back(b <= 0      ? maps::Occupancy::free
                        : b <= wall ? maps::Occupancy::occupied
                                    : maps::Occupancy::unknown);
  return map;
}

}  // namespace slalom::vehicle
