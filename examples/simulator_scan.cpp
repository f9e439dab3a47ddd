// The simulator alone: two cars and a barrel on a map, and the scan of the first car's LiDAR, as an SVG
// picture.
//
//   simulator_scan OUT.svg [MAP.yaml X Y YAW]
//
// The second car stands 2 m ahead of the first, the barrel 1.2 m ahead and to its right.
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <string>

#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/world.hpp"

namespace maps = slalom::maps;
namespace sim = slalom::sim;

namespace {

/// A ring road, 3 m wide, used without a map file.
maps::OccupancyGrid ring_road() {
  maps::OccupancyGrid grid{400, 400, 0.05, {}, std::vector<maps::Occupancy>(160000, maps::Occupancy::free)};
  for (int row = 0; row < 400; ++row)
    for (int column = 0; column < 400; ++column) {
      const double distance = std::hypot(0.05 * (column + 0.5) - 10, 0.05 * (row + 0.5) - 10);
      if (distance < 5 || distance > 8) grid.at(column, row) = maps::Occupancy::occupied;
    }
  return grid;
}

/// Writes shapes given in the map frame; the picture's y axis points down, the map's up.
class Picture {
 public:
  Picture(const std::string& file, const sim::Track& track) : out_(file), track_(track) {
    const maps::OccupancyGrid& grid = track.grid();
    out_ << "<svg xmlns='http://www.w3.org/2000/svg' width='1000' viewBox='0 0 " << grid.width << ' '
         << grid.height << "'>\n<rect width='100%' height='100%' fill='white'/>\n";
    for (int row = 0; row < grid.height; ++row)
      for (int column = 0, end; column < grid.width; column = end) {
        end = column + 1;
        if (!track.is_wall(column, row)) continue;
        while (end < grid.width && track.is_wall(end, row)) ++end;
        out_ << "<rect x='" << column << "' y='" << grid.height - 1 - row << "' width='" << end - column
             << "' height='1' fill='#555' shape-rendering='crispEdges'/>\n";
      }
  }
  ~Picture() { out_ << "</svg>\n"; }

  void line(const maps::Point& from, const maps::Point& to, const char* colour, double width) {
    const maps::Point a = pixel(from), b = pixel(to);
    out_ << "<line x1='" << a.x << "' y1='" << a.y << "' x2='" << b.x << "' y2='" << b.y << "' stroke='"
         << colour << "' stroke-width='" << width << "'/>\n";
  }
  void disc(const maps::Point& middle, double radius, const char* colour) {
    const maps::Point at = pixel(middle);
    out_ << "<circle cx='" << at.x << "' cy='" << at.y << "' r='" << radius / track_.grid().resolution
         << "' fill='" << colour << "'/>\n";
  }
  void car(const sim::Box& box, const char* colour) {
    out_ << "<polygon fill='" << colour << "' points='";
    for (const maps::Point& corner : sim::corners(box))
      out_ << pixel(corner).x << ',' << pixel(corner).y << ' ';
    out_ << "'/>\n";
    // A white line at the front of the car.
    const auto c = sim::corners({maps::Pose{box.pose}, box.length * 0.6, box.width});
    line(c[2], c[3], "white", 1);
  }

 private:
  maps::Point pixel(const maps::Point& point) const {
    const maps::Point cell = track_.to_cells(point);
    return {cell.x, track_.grid().height - cell.y};
  }

  std::ofstream out_;
  const sim::Track& track_;
};

void draw(const std::string& file, const sim::World& world) {
  const sim::Observation seen = world.observe(0);
  Picture picture(file, world.track());
  for (std::size_t i = 0; i < seen.scan.ranges.size(); ++i) {
    const double angle = seen.scan.angle_min + static_cast<double>(i) * seen.scan.angle_increment;
    const double range = static_cast<double>(seen.scan.ranges[i]);
    const maps::Point hit = maps::transform(seen.sensor, {range * std::cos(angle), range * std::sin(angle)});
    if (i % 6 == 0) picture.line({seen.sensor.x, seen.sensor.y}, hit, "#f6c9a0", 0.4);
    picture.disc(hit, 0.03, "#d62728");
  }
  for (std::size_t body = 0; body < world.bodies(); ++body) {
    if (const auto disc = world.disc(body))
      picture.disc(disc->middle, disc->radius, "#2ca02c");
    else
      picture.car(world.outline(body), body == 0 ? "#1f77b4" : "#9467bd");
  }
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 2 && count != 6) {
    std::fprintf(stderr, "usage: simulator_scan OUT.svg [MAP.yaml X Y YAW]\n");
    return 2;
  }
  const bool has_map = count == 6;
  const auto track =
      std::make_shared<const sim::Track>(has_map ? maps::load_ros_map(arguments[2]) : ring_road());
  const maps::Pose start =
      has_map ? maps::Pose{std::stod(arguments[3]), std::stod(arguments[4]), std::stod(arguments[5])}
              : maps::Pose{16.5, 10, 1.6};
  const auto ahead = [&](double x, double y) { return maps::transform(start, {x, y}); };

  sim::World world({}, track);
  const maps::Point second = ahead(2, 0.1);
  world.reset(1, std::array{start, maps::Pose{second.x, second.y, start.yaw + 0.4}});
  world.add_disc({ahead(1.2, -0.5), 0.12});
  world.step(std::array{slalom::Command{0, 0}, slalom::Command{0, 0}});
  draw(arguments[1], world);

  const sim::Observation seen = world.observe(0);
  std::printf("%zu beams, %.2f m straight ahead\n", seen.scan.ranges.size(),
              static_cast<double>(seen.scan.ranges[seen.scan.ranges.size() / 2]));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "simulator_scan: %s\n", error.what());
  return 1;
}
