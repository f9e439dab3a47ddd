// Any path into planner, navigator and the logic of the ROS nodes; and any line with any map into a course.
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "fuzz/target.hpp"
#include "logic/path_follower.hpp"
#include "logic/planner_core.hpp"
#include "sim/rooms.hpp"
#include "slalom/vehicle/racing/race_course.hpp"
#include "vehicle/planner/planner_calls.hpp"

namespace slalom::fuzz {
namespace {

using testing::Adversary;
using namespace std::string_view_literals;

/// Points on a circle, a spiral, a line or a zigzag, or anywhere; closed or open, of any size and density.
std::vector<maps::ReferencePoint> any_path(Adversary& adversary, int most) {
  const int count = adversary.below(adversary.once_in(3) ? 8 : most), kind = adversary.below(5);
  double scale = adversary.within(0.1, 20);
  if (adversary.once_in(3)) scale = std::pow(10, adversary.within(-12, 8));
  const double turns = adversary.once_in(2) ? 1 : adversary.within(-5, 5),
               noise = adversary.once_in(2) ? 0 : scale * adversary.within(0, 1),
               aside = adversary.once_in(2) ? 0 : adversary.any(-100, 100),
               speed = adversary.once_in(2) ? 3 : adversary.any(0, 10);
  std::vector<maps::ReferencePoint> path;
  for (int i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / count, angle = 2 * std::numbers::pi * turns * part,
                 radius = kind == 1 ? scale * part : scale;
    maps::ReferencePoint at{radius * std::cos(angle), radius * std::sin(angle), angle, speed};
    if (kind == 2) at = {scale * (part - 0.5), 0, 0, speed};
    if (kind == 3) at = {scale * part, scale * (i % 2), 0, speed};
    if (kind == 4)
      at = {adversary.any(-scale, scale), adversary.any(-scale, scale), adversary.any(-4, 4), speed};
    if (noise > 0) at.y += adversary.within(-noise, noise);
    at.x += aside;
    path.push_back(at);
  }
  if (!path.empty() && adversary.once_in(6)) path.push_back(path.front());
  return path;
}

/// Three updates of a planner on a path. Throws std::invalid_argument.
void drive_along(Adversary& adversary, const std::vector<maps::ReferencePoint>& path) {
  const vehicle::PlannerOptions options;
  vehicle::VehicleOptions car;
  car.model = vehicle::VehicleModelId{adversary.below(static_cast<int>(vehicle::VehicleModels::size))};
  vehicle::Planner planner(options, vehicle::make_vehicle_model(car), path,
                           make_solver(testing::few_samples("mppi"), vehicle::input_count(car)));
  std::vector<float> ranges;
  for (std::size_t i = 0; i < 3; ++i) {
    const maps::ReferencePoint& at = path.at(path.size() * i / 3);
    testing::check_output(planner.update({testing::any_scan(adversary, ranges), {{at.x, at.y, at.yaw}, 1}}),
                          options);
  }
}

/// A path as a message to the node of a car. Returns whether it is taken.
bool hear_path(const std::vector<maps::ReferencePoint>& path) {
  bool taken = false;
  const auto clock = [] { return 1000.0; };
  const auto log = [](const std::string&) {};
  nodes::PlannerCore core({.configuration = "", .method = "mppi", .course = {}, .limits = {}}, {clock, clock},
                          {}, {{}, {}, [&](const auto&, bool) { taken = true; }, log, log});
  core.change({{"mppi.samples", "32"}});
  core.hear_path(path);
  core.hear_goal_speed(3);
  return taken;
}

/// A path as a plan of nav2, which a navigator follows, and three updates. Throws std::invalid_argument.
void follow(const std::vector<maps::ReferencePoint>& path) {
  std::vector<maps::Pose> poses;
  for (const maps::ReferencePoint& at : path) poses.push_back({at.x, at.y, at.yaw});
  nodes::PathFollower follower("mppi");
  follower.change({{"batch_size", "32"}});
  follower.use_footprint({{0.2, 0.2}, {-0.2, 0.2}, {-0.2, -0.2}, {0.2, -0.2}});
  const std::vector<unsigned char> costs(80 * 80, 0);
  follower.use_costmap({80, 80, 0.05, -2, -2, costs.data()});
  follower.use_plan(poses);
  for (int i = 0; i < 3; ++i) {
    const nodes::FollowerAnswer answer = follower.update({{0, 0, 0}, {}, 100 + 0.05 * i, {}, {}});
    const navigation::Velocity& v = answer.command;
    require(std::isfinite(v.forward + v.left + v.turn + answer.remaining), "commands to a robot are finite");
  }
}

const Target path_target(
    "path", 4096,
    []() -> Seeds { return random_bytes(40, 300, "\1\1\0\xc8\0\x32\x2f\1\0\0\0\0\1"sv); },  // a circle of 4 m
    [](std::string_view bytes) {
      Adversary adversary(bytes);
      const int taker = adversary.below(3);
      const auto path = any_path(adversary, 3000);
      try {
        if (taker == 0) return hear_path(path);
        taker == 1 ? drive_along(adversary, path) : follow(path);
        return true;
      } catch (const std::logic_error& error) {  // no path
        if (dynamic_cast<const testing::Finding*>(&error)) throw;
        return false;
      }
    },
    20);

/// A ring road, a hall or one with points, of any resolution and place; small, since a raceline takes 1 to 3
/// ms for each of its points.
maps::OccupancyGrid any_map(Adversary& adversary) {
  const int size = 8 + adversary.below(24), kind = adversary.below(3);
  maps::OccupancyGrid map = testing::room(size, size, adversary.within(0.05, 0.15));
  if (adversary.once_in(8)) map.resolution = adversary.any(0.01, 0.2);
  map.origin.x = map.origin.y = -0.5 * size * map.resolution;
  if (adversary.once_in(8))
    map.origin = {adversary.any(-10, 10), adversary.any(-10, 10), adversary.any(-4, 4)};
  for (int cell = 0; cell < size * size && kind == 0; ++cell) {
    const double away = std::hypot(cell / size - 0.5 * size, cell % size - 0.5 * size) / size;
    if (away < 0.2 || away > 0.45) map.at(cell % size, cell / size) = maps::Occupancy::occupied;
  }
  for (int points = kind == 2 ? adversary.below(6) : 0; points > 0; --points)
    map.at(adversary.below(size), adversary.below(size)) = static_cast<maps::Occupancy>(adversary.below(3));
  return map;
}

const Target map_line_target(
    "map_line", 2048,
    []() -> Seeds { return random_bytes(40, 200, "\x17\0\xff\xff\1\1\1\0\x28\0\x12\x02\1\0\0\0\0\1"sv); },
    [](std::string_view bytes) {
      Adversary adversary(bytes);
      const maps::OccupancyGrid map = any_map(adversary);
      std::string text;
      for (const auto& at : any_path(adversary, 300)) text += to_text(at.x) + "," + to_text(at.y) + "\n";
      const auto line = vehicle::read_centre_line(scratch_file("line.csv", text)).line;
      try {
        const vehicle::Raceline made = vehicle::race_course(map, {}, {}, &line).raceline;
        require(std::isfinite(made.time) && made.length > 0, "a raceline has length and time");
        for (const auto& at : made.points)
          require(std::isfinite(at.x + at.y + at.yaw) && at.speed > 0, "points of a raceline are finite");
        return true;
      } catch (const std::invalid_argument&) {  // they do not fit
        return false;
      }
    },
    100);

}  // namespace
}  // namespace slalom::fuzz
