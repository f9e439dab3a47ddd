#include "evaluation/racing/starting_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>

namespace slalom::evaluation {
namespace {

constexpr double wall_room = 0.1;                       // m, around a car on the grid
constexpr double offset_step = 0.05, back_step = 0.25;  // m

}  // namespace

std::vector<maps::Pose> starting_grid(const Environment& environment, double line, int cars,
                                      const sim::CarParameters& car, const GridRaceOptions& options) {
  const sim::LapPath& path = *environment.track->lap_path();
  const auto pose_at = [&](double arc, double left) -> std::optional<maps::Pose> {
    maps::Pose pose = path.at(arc);
    pose.x -= left * std::sin(pose.yaw);
    pose.y += left * std::cos(pose.yaw);
    if (environment.track->collides_with_wall(
            {.pose = pose, .length = car.length + 2 * wall_room, .width = car.width + 2 * wall_room}))
      return std::nullopt;
    return pose;
  };
  std::vector<maps::Pose> grid;
  double arc = line;
  while (static_cast<int>(grid.size()) < cars) {
    std::optional<maps::Pose> pose;
    const double side = grid.size() % 2 == 0 ? 1 : -1;
    for (double offset = options.place_offset; !pose && offset > 0; offset -= offset_step)
      pose = pose_at(arc, side * offset);
    if (!pose) pose = pose_at(arc, 0);
    if (pose) grid.push_back(*pose);
    arc -= pose ? options.place_spacing : back_step;
    if (line - arc > 0.25 * path.length() && static_cast<int>(grid.size()) < cars)
      throw std::runtime_error("course " + environment.course.name + ": no room for a grid of " +
                               std::to_string(cars) + " cars");
  }
  return grid;
}

std::vector<int> standings_of(std::span<const CarResult> cars) {
  std::vector<int> order(cars.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const CarResult& car = cars[static_cast<std::size_t>(i)];
    const bool finished = car.end == CarEnd::finished;
    return std::tuple(finished ? 0 : 1, finished ? car.time : -car.progress, car.grid_place);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

}  // namespace slalom::evaluation
