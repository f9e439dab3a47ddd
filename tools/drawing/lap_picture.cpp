#include "tools/drawing/lap_picture.hpp"

#include <algorithm>
#include <cmath>

#include "slalom/sim/shapes.hpp"
#include "tools/drawing/map_picture.hpp"

namespace slalom::tools {
namespace {

constexpr Colour path_colour{0.62, 0.66, 0.73, 0.9};
constexpr Colour obstacle_fill{0.32, 0.36, 0.44, 1};
constexpr Colour hit_fill{0.80, 0.13, 0.23, 1};

void draw_cross(MapPicture& picture, const maps::Point& at, double size) {
  for (const auto& [colour, width] : {std::pair(white, 9.0), std::pair(hit_fill, 4.5)})
    for (const double side : {1.0, -1.0})
      picture.line({{at.x - size, at.y - side * size}, {at.x + size, at.y + side * size}}, colour, width,
                   false);
}

}  // namespace

void draw_lap(const LapPicture& picture, const std::filesystem::path& file) {
  std::vector<maps::Point> path, shown = picture.driven.points;
  for (const auto& point : picture.path) path.push_back({point.x, point.y});
  shown.insert(shown.end(), path.begin(), path.end());
  const maps::OccupancyGrid map = cropped(picture.map, shown, 3.0);
  MapPicture drawn(map, 1400);

  drawn.line(path, path_colour, 2, picture.closed, true);
  const auto& speeds = picture.driven.speeds;
  double slowest = 0, fastest = 1;
  if (!speeds.empty()) {
    // Acceleration from standstill would take up most of the scale.
    auto sorted = speeds;
    std::sort(sorted.begin(), sorted.end());
    slowest = std::floor(2 * sorted[sorted.size() / 50]) / 2;
    fastest = std::max(std::ceil(2 * sorted.back()) / 2, slowest + 0.5);
  }
  drawn.speed_line(picture.driven.points, speeds, slowest, fastest, 6, false);

  const auto was_hit = [&](std::size_t body) {
    return std::any_of(picture.lap.first_collisions.begin(), picture.lap.first_collisions.end(),
                       [&](const auto& collision) { return collision.body == static_cast<int>(body); });
  };
  const sim::CarParameters car;
  for (std::size_t i = 0; i < picture.lap.obstacles.size(); ++i) {
    const auto corners = sim::corners({picture.lap.obstacles[i], car.length, car.width});
    drawn.polygon({corners.begin(), corners.end()}, was_hit(i + 1) ? hit_fill : obstacle_fill, white);
  }
  drawn.arrow(picture.start, 20, ink);
  const double cross = 0.010 * std::max(map.width, map.height) * map.resolution;
  for (const auto& collision : picture.lap.first_collisions)
    draw_cross(drawn, {collision.pose.x, collision.pose.y}, cross);
  drawn.legend(picture.title, picture.facts, slowest, fastest);
  drawn.save(file);
}

}  // namespace slalom::tools
