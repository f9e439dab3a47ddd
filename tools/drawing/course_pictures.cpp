#include "tools/drawing/course_pictures.hpp"

#include "slalom/sim/shapes.hpp"
#include "tools/command_line/words.hpp"
#include "tools/drawing/map_picture.hpp"
#include "tools/scenario/lap_json.hpp"

namespace slalom::tools {
namespace {

constexpr Colour line_colour{0.62, 0.66, 0.73, 0.9};  // centre lines and paths
constexpr Colour corridor_side{0.16, 0.52, 0.36, 0.7};
constexpr Colour nearest{0.80, 0.13, 0.18, 1};
constexpr Colour tightest{0.42, 0.20, 0.62, 1};
constexpr int picture_side = 1400;  // pixels

template <class Points>
std::vector<maps::Point> positions(const Points& points) {
  std::vector<maps::Point> all;
  for (const auto& point : points) all.push_back({point.x, point.y});
  return all;
}

template <class Points>
std::vector<double> speeds_of(const Points& points) {
  std::vector<double> all;
  for (const auto& point : points) all.push_back(point.speed);
  return all;
}

/// The scale of colours for these speeds: from the quantile `low` to the largest, in steps of 0.5 m/s.
std::pair<double, double> speed_scale(std::vector<double> speeds, double low = 0) {
  if (speeds.empty()) return {0, 1};
  std::sort(speeds.begin(), speeds.end());
  const auto first = static_cast<std::size_t>(low * static_cast<double>(speeds.size()));
  const double slowest = std::floor(2 * speeds[first]) / 2;
  return {slowest, std::max(std::ceil(2 * speeds.back()) / 2, slowest + 0.5)};
}

maps::Point moved(const maps::Point& from, const maps::Point& normal, double way) {
  return {from.x + way * normal.x, from.y + way * normal.y};
}

}  // namespace

void draw_lap(const maps::OccupancyGrid& map, const evaluation::LapSetup& setup, const DrivenLine& driven,
              const evaluation::LapResult& lap, const std::string& title, const std::filesystem::path& file) {
  const std::vector<maps::Point> path = positions(setup.environment->path);
  std::vector<maps::Point> shown = driven.points;
  shown.insert(shown.end(), path.begin(), path.end());
  MapPicture picture(map, picture_side, shown, 3);
  picture.line(path, line_colour, 2, setup.environment->course.closed, true);
  // Acceleration from standstill would take up most of the scale.
  const auto [slowest, fastest] = speed_scale(driven.speeds, 0.02);
  picture.speed_line(driven.points, driven.speeds, slowest, fastest, 6, false);

  const auto was_hit = [&](std::size_t body) {
    return std::any_of(lap.first_collisions.begin(), lap.first_collisions.end(),
                       [&](const auto& collision) { return collision.body == static_cast<int>(body); });
  };
  const sim::CarParameters car;
  for (std::size_t i = 0; i < lap.obstacles.size(); ++i) {
    const auto corners = sim::corners({lap.obstacles[i], car.length, car.width});
    picture.polygon({corners.begin(), corners.end()}, was_hit(i + 1) ? hit_colour : obstacle_colour, white);
  }
  picture.arrow(setup.start(), 20, ink);
  for (const auto& collision : lap.first_collisions)
    picture.cross({collision.pose.x, collision.pose.y}, 14, hit_colour);

  const std::string facts = formatted(
      "%s after %.2f s \xC2\xB7 mean %.2f m/s \xC2\xB7 %d collision%s \xC2\xB7 cost %.2f \xC2\xB7 %zu "
      "obstacles, seed %llu",
      end_name(lap), lap.time, lap.mean_speed, lap.collisions, lap.collisions == 1 ? "" : "s",
      lap.mean_sequence_cost(), lap.obstacles.size(), static_cast<unsigned long long>(lap.seed));
  picture.legend(title, facts, slowest, fastest);
  picture.save(file);
}

void draw_plans(const maps::OccupancyGrid& map, const evaluation::LapSetup& setup, const DrivenLine& driven,
                const std::vector<std::vector<maps::Point>>& plans, const std::string& title,
                const std::filesystem::path& file) {
  MapPicture picture(map, picture_side, driven.points, 3);
  picture.line(positions(setup.environment->path), line_colour, 2, setup.environment->course.closed, true);
  const auto [slowest, fastest] = speed_scale(driven.speeds, 0.02);
  picture.speed_line(driven.points, driven.speeds, slowest, fastest, 6, false);
  for (const auto& plan : plans) picture.line(plan, ink, 2, false);
  picture.legend(title, "driven line by its speed \xC2\xB7 plans from it every 0.5 s (black)", slowest,
                 fastest);
  picture.save(file);
}

void draw_course(const vehicle::RaceCourse& course, const vehicle::RacingCar& car, const std::string& title,
                 const std::filesystem::path& file) {
  const vehicle::Corridor& corridor = course.corridor;
  std::vector<maps::Point> left, right;
  for (std::size_t i = 0; i < corridor.centre_line.size(); ++i) {
    left.push_back(moved(corridor.centre_line[i], corridor.normal[i], corridor.left[i]));
    right.push_back(moved(corridor.centre_line[i], corridor.normal[i], -corridor.right[i]));
  }
  const auto& points = course.raceline.points;
  const std::vector<maps::Point> line = positions(points);
  const auto near = static_cast<std::size_t>(
      std::min_element(course.distance.begin(), course.distance.end()) - course.distance.begin());
  const auto tight =
      static_cast<std::size_t>(std::max_element(points.begin(), points.end(),
                                                [](const auto& a, const auto& b) {
                                                  return std::abs(a.curvature) < std::abs(b.curvature);
                                                }) -
                               points.begin());
  MapPicture picture(course.map, picture_side);
  picture.line(left, corridor_side, 2, corridor.closed);
  picture.line(right, corridor_side, 2, corridor.closed);
  picture.line(corridor.centre_line, line_colour, 1.5, corridor.closed, true);
  const std::vector<double> speeds = speeds_of(points);
  const auto [slowest, fastest] = speed_scale(speeds);
  picture.speed_line(line, speeds, slowest, fastest, 5, corridor.closed);
  picture.disc(line[near], 8, nearest);
  picture.disc(line[tight], 8, tightest);
  picture.arrow(course.start, 18, ink);

  const std::string facts = formatted(
      "%s \xC2\xB7 %.1f m \xC2\xB7 %s %.2f s \xC2\xB7 %.2f m from body to wall (red) \xC2\xB7 radius %.2f m "
      "(violet), the car turns %.2f m",
      car.name.c_str(), course.raceline.length, corridor.closed ? "lap" : "drive", course.raceline.time,
      course.distance[near] - 0.5 * car.width, 1 / std::max(std::abs(points[tight].curvature), 1e-9),
      1 / vehicle::max_curvature(car));
  picture.legend(title, facts, slowest, fastest);
  picture.save(file);
}

void draw_track(const vehicle::GeneratedTrack& track, const std::string& title,
                const std::filesystem::path& file) {
  MapPicture picture(track.map);
  const std::vector<double> speeds = speeds_of(track.raceline);
  const auto [slowest, fastest] = speed_scale(speeds);
  picture.line(track.centre_line, line_colour, 2, true, true);
  picture.speed_line(positions(track.raceline), speeds, slowest, fastest, 7, true);
  const auto& start = track.raceline.front();
  const maps::Point foot = track.centre_line.front(), across{-std::sin(start.yaw), std::cos(start.yaw)};
  const double half = 0.5 * track.options.width;
  picture.line({moved(foot, across, -half), moved(foot, across, half)}, ink, 4, false);
  picture.arrow({start.x, start.y, start.yaw}, 20, ink);

  const std::string facts =
      formatted("%s, seed %llu \xC2\xB7 %.1f m long, %.1f m wide \xC2\xB7 profile lap %.1f s",
                vehicle::name(track.options.character), static_cast<unsigned long long>(track.options.seed),
                vehicle::path_length(track), track.options.width, track.lap_time);
  picture.legend(title, facts, slowest, fastest);
  picture.save(file);
}

}  // namespace slalom::tools
