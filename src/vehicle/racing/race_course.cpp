#include "slalom/vehicle/racing/race_course.hpp"

#include <cstdio>

#include "slalom/core/numbers/count.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/maps/reference_path.hpp"
#include "vehicle/course/track_parts.hpp"
#include "vehicle/racing/free_space.hpp"
#include "vehicle/racing/map_corridor.hpp"

namespace slalom::vehicle {
namespace {

constexpr double widest = 25;              // reach of a corridor to one side, in half widths of the car
constexpr double max_line_points = 3000;   // points of a centre line
constexpr int max_rounds = 4;              // rounds of improving a line along its own normals
constexpr double min_gain = 5e-4;          // share of the time, by which a round must improve it
constexpr double min_room = 1e-3;          // m, between the bounds of a line
constexpr double max_yaw = 0.6;            // rad, of the way from the x axis at a start that is found
constexpr double most_cells_of_car = 200;  // cells of a map across the car
constexpr double run_out = 5;              // m beyond the ends of an open course, in widths of the car
constexpr double standing_room = 0.65;     // distance from walls of a start on the raceline, in car widths
constexpr double other_length = 0.1;  // share by which a raceline may differ from its line without a note
constexpr double pinch = 1 / 3.0;     // share of the median width, below which the narrowest is a doubt
constexpr double half_turn = 3.14159265358979323846;  // rad

std::string text_of(const maps::Point& point) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f)", point.x, point.y);
  return text;
}

std::string rounded(double length) {
  return to_text(std::round(100 * length) / 100);
}

std::vector<maps::Point> line_of(const Raceline& raceline) {
  std::vector<maps::Point> line;
  for (const RacelinePoint& point : raceline.points) line.push_back({point.x, point.y});
  return line;
}

/// The yaw of a line of cells, which has eight directions from cell to cell, over some of them.
double yaw_at(const std::vector<maps::Point>& line, bool closed, std::size_t at) {
  const std::size_t n = line.size(), reach = std::min<std::size_t>(5, n / 4);
  const std::size_t before = closed ? (at + n - reach) % n : at - std::min(at, reach);
  const std::size_t after = closed ? (at + reach) % n : std::min(at + reach, n - 1);
  return std::atan2(line[after].y - line[before].y, line[after].x - line[before].x);
}

/// The row of a line at which a car stands, facing along it, or also against it.
std::size_t row_at(const std::vector<maps::Point>& line, bool closed, const maps::Pose& car,
                   bool also_against) {
  const auto squared_to = [&](std::size_t i) { return std::pow(distance(line[i], {car.x, car.y}), 2); };
  const auto turned = [&](std::size_t i) {
    return (also_against ? 2 : 1) * (car.yaw - yaw_at(line, closed, i));
  };
  return maps::place_on_path(line.size(), squared_to, turned, line.size());
}

/// The cosine of the angle between a pose and the line where it stands.
double along(const std::vector<maps::Point>& line, bool closed, const maps::Pose& pose) {
  return std::cos(pose.yaw - yaw_at(line, closed, row_at(line, closed, pose, true)));
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
    const std::size_t first =
        start ? row_at(line_of(course.raceline), true, *start, false) : detail::start_row(speeds);
    const double before = points[first].arc_length;
    const double length = course.raceline.length;
    begin_at(points, first);
    for (RacelinePoint& point : points)
      point.arc_length = std::fmod(point.arc_length - before + length, length);
    points.front().arc_length = 0;
    Corridor& corridor = course.corridor;
    const RacelinePoint& begin = points.front();
    const std::size_t row = row_at(corridor.centre_line, true, {begin.x, begin.y, begin.yaw}, false);
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
    const Corridor along_line = detail::measured_corridor(space, line_of(best), best.closed, measure);
    for (std::size_t i = 0; i < along_line.left.size(); ++i)
      if (along_line.left[i] + along_line.right[i] <= 2 * measure.keep + min_room ||
          measure.keeps(space, along_line.centre_line[i]))
        return best;
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
  const auto nearest = std::min_element(course.distance.begin(), course.distance.end());
  const RacelinePoint& there =
      course.raceline.points[static_cast<std::size_t>(nearest - course.distance.begin())];
  if (*nearest < 0.5 * car.width - space.map().resolution)
    throw std::invalid_argument("corridor: the raceline is " + to_text(*nearest) + " m from a wall at " +
                                text_of({there.x, there.y}) + "; the centre line must be smoother there");
  // Where the raceline touches a wall, the car starts in the middle of the road.
  if (!start && course.distance[0] < standing_room * car.width) {
    const Corridor& corridor = course.corridor;
    const double aside = 0.5 * (corridor.left[0] - corridor.right[0]);
    course.start.x = corridor.centre_line[0].x + aside * corridor.normal[0].x;
    course.start.y = corridor.centre_line[0].y + aside * corridor.normal[0].y;
  }
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

/// Notes on what the maker of a course may not have meant.
void add_doubts(RaceCourse& course, const GuideLine* guide) {
  const auto& [line, normal, left, right, closed] = course.corridor;
  if (guide) {
    const double given = detail::length(guide->points, guide->closed), made = course.raceline.length;
    if (std::abs(made - given) > other_length * given)
      course.notes.push_back("the raceline is " + rounded(made) + " m long, and the line " + rounded(given) +
                             " m");
    return;
  }
  std::vector<double> widths(left);
  for (std::size_t i = 0; i < left.size(); ++i) widths[i] += right[i];
  const auto narrowest = std::min_element(widths.begin(), widths.end());
  const maps::Point place = line[static_cast<std::size_t>(narrowest - widths.begin())];
  const double least = *narrowest;
  std::nth_element(widths.begin(), widths.begin() + widths.size() / 2, widths.end());
  if (least < pinch * widths[widths.size() / 2])
    course.notes.push_back("the course leads through a gap of " + rounded(least) + " m at " + text_of(place) +
                           ", and is " + rounded(widths[widths.size() / 2]) +
                           " m wide mostly; --narrowest excludes gaps, --line gives the way");
}

/// The loop that passes the start. Without a start, the origin of the map frame becomes it if the loop passes
/// there about along its x axis.
std::vector<maps::Point> found_loop(const detail::FreeSpace& space, double keep,
                                    std::optional<maps::Pose>& start, std::vector<std::string>& notes) {
  const auto near = start ? std::optional(maps::Point{start->x, start->y}) : std::nullopt;
  std::optional<maps::Point> rival;
  std::vector<maps::Point> line = detail::find_loop(space, keep, near, rival);
  if (rival)
    notes.push_back("another loop, through " + text_of(*rival) +
                    ", is as long for its width; --start or --line chooses between them");
  if (line.empty()) {
    char text[200];
    std::snprintf(text, sizeof text, "map: no closed way%s keeps %.3f m from all walls%s",
                  start ? (" that passes the start " + text_of({start->x, start->y})).c_str() : "", keep,
                  start ? "" : "; an open course needs a line to drive along");
    throw std::invalid_argument(text);
  }
  const maps::Point &origin{0, 0}, &passed = line[row_at(line, true, {}, true)];
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
  std::vector<maps::Point> line =
      guide ? guide->points : found_loop(space, std::max(keep, 0.5 * options.narrowest), start, course.notes);
  const bool closed = !guide || guide->closed;
  if (start && along(line, closed, *start) < 0) std::reverse(line.begin(), line.end());
  if (options.reverse) std::reverse(line.begin(), line.end());
  if (options.reverse && start) start->yaw = maps::wrap_angle(start->yaw + half_turn);
  auto measure = measure_for(car, detail::length(line, closed));
  measure.keeps_line = guide;
  course.corridor = detail::centred_corridor(space, line, closed, measure);
  complete(course, space, car, measure, start);
  add_doubts(course, guide);
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

}  // namespace slalom::vehicle
