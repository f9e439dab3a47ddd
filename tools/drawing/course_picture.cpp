#include "tools/drawing/course_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/drawing/map_picture.hpp"

namespace slalom::tools {
namespace {

constexpr Colour faint{0.62, 0.66, 0.73, 0.8};
constexpr Colour corridor_side{0.16, 0.52, 0.36, 0.7};
constexpr Colour nearest{0.80, 0.13, 0.18, 1};
constexpr Colour tightest{0.42, 0.20, 0.62, 1};
constexpr double margin = 2;  // m, of the map around the course

maps::Point moved(const maps::Point& from, const maps::Point& normal, double way) {
  return {from.x + way * normal.x, from.y + way * normal.y};
}

}  // namespace

void draw_course(const vehicle::RaceCourse& course, const vehicle::RacingCar& car, const std::string& title,
                 const std::filesystem::path& file) {
  const vehicle::Corridor& corridor = course.corridor;
  std::vector<maps::Point> left, right, line;
  for (std::size_t i = 0; i < corridor.centre_line.size(); ++i) {
    left.push_back(moved(corridor.centre_line[i], corridor.normal[i], corridor.left[i]));
    right.push_back(moved(corridor.centre_line[i], corridor.normal[i], -corridor.right[i]));
  }
  std::vector<double> speeds;
  std::size_t near = 0, tight = 0;
  const auto& points = course.raceline.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    line.push_back({points[i].x, points[i].y});
    speeds.push_back(points[i].speed);
    if (course.distance[i] < course.distance[near]) near = i;
    if (std::abs(points[i].curvature) > std::abs(points[tight].curvature)) tight = i;
  }
  std::vector<maps::Point> shown = left;
  shown.insert(shown.end(), right.begin(), right.end());
  MapPicture picture(cropped(course.map, shown, margin), 1400);
  picture.line(left, corridor_side, 2, corridor.closed);
  picture.line(right, corridor_side, 2, corridor.closed);
  picture.line(corridor.centre_line, faint, 1.5, corridor.closed, true);
  const auto [slow, fast] = std::minmax_element(speeds.begin(), speeds.end());
  const double slowest = std::floor(2 * *slow) / 2, fastest = std::ceil(2 * *fast) / 2;
  picture.speed_line(line, speeds, slowest, fastest, 5, corridor.closed);
  picture.disc(line[near], 8, nearest);
  picture.disc(line[tight], 8, tightest);
  picture.arrow(course.start, 18, ink);

  char facts[400];
  std::snprintf(
      facts, sizeof facts,
      "%s \xC2\xB7 %.1f m \xC2\xB7 %s %.2f s \xC2\xB7 %.2f m from body to wall (red) \xC2\xB7 radius %.2f m "
      "(violet), the car turns %.2f m",
      car.name.c_str(), vehicle::length(corridor), corridor.closed ? "lap" : "drive", course.raceline.time,
      course.distance[near] - 0.5 * car.width, 1 / std::max(std::abs(points[tight].curvature), 1e-9),
      1 / vehicle::max_curvature(car));
  picture.legend(title, facts, slowest, fastest);
  picture.save(file);
}

}  // namespace slalom::tools
