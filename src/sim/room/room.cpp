#include "slalom/sim/room/room.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/options.hpp"
#include "slalom/maps/laser_scan.hpp"

namespace slalom::sim {
namespace {

/// The cells that cover a length. One that is a multiple of the resolution but for rounding takes no more.
int cells_of(double length, double resolution) {
  return saturate_cast<int>(std::ceil(length / resolution - 1e-9));
}

/// The way (m) along a ray from inside to the edge of the floor.
double way_out(double position, double direction, double length) {
  if (direction > 0) return (length - position) / direction;
  if (direction < 0) return -position / direction;
  return std::numeric_limits<double>::infinity();
}

}  // namespace

maps::OccupancyGrid map_of(const Room& room, double resolution) {
  using slalom::detail::check;
  check("room", {"length", "m", "", 1, 1000}, room.length);
  check("room", {"width", "m", "", 1, 1000}, room.width);
  check("room", {"resolution", "m", "", 0.01, 1}, resolution);
  maps::OccupancyGrid grid;
  grid.resolution = resolution;
  grid.width = cells_of(room.length, resolution) + 2;
  grid.height = cells_of(room.width, resolution) + 2;
  grid.origin = {-resolution, -resolution, 0};
  grid.cells.assign(static_cast<std::size_t>(grid.width) * grid.height, maps::Occupancy::free);
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) {
      const bool rim = row == 0 || column == 0 || row == grid.height - 1 || column == grid.width - 1;
      const Box cell{
          {grid.origin.x + (column + 0.5) * resolution, grid.origin.y + (row + 0.5) * resolution, 0},
          resolution,
          resolution};
      // Cells that only touch a wall are free.
      const bool wall = rim || std::any_of(room.walls.begin(), room.walls.end(),
                                           [&](const Box& each) { return signed_gap(each, cell) < -1e-6; });
      if (wall) grid.at(column, row) = maps::Occupancy::occupied;
    }
  return grid;
}

bool collides(const Room& room, const Box& body) noexcept {
  for (const maps::Point& corner : corners(body))
    if (!(corner.x >= 0 && corner.x <= room.length && corner.y >= 0 && corner.y <= room.width)) return true;
  const auto hits = [&](const auto& other) { return signed_gap(body, other) <= 0; };
  const auto any_hits = [&](const auto& bodies) { return std::any_of(bodies.begin(), bodies.end(), hits); };
  return any_hits(room.walls) || any_hits(room.obstacles) || any_hits(room.people) || any_hits(room.posts);
}

void scan(const Room& room, const maps::Pose& scanner, double max_range, std::span<double> ranges) noexcept {
  const maps::Point from{scanner.x, scanner.y};
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = scanner.yaw + maps::beam_angle(i, ranges.size());
    const double cosine = std::cos(angle), sine = std::sin(angle);
    double range =
        std::min({max_range, way_out(from.x, cosine, room.length), way_out(from.y, sine, room.width)});
    const auto shorten = [&](const auto& bodies) {
      for (const auto& body : bodies) range = std::min(range, ray_distance(from, cosine, sine, body));
    };
    shorten(room.walls);
    shorten(room.obstacles);
    shorten(room.people);
    shorten(room.posts);
    ranges[i] = range;
  }
}

}  // namespace slalom::sim
