#pragma once

#include <optional>

#include "navigation/grids.hpp"
#include "slalom/navigation/navigator.hpp"

/// Whole drives of a robot that moves as it is told.
namespace slalom::navigation {

inline constexpr double drive_period = 0.05;  // s
inline constexpr double pi = std::numbers::pi;

/// A robot on a floor, by default a room of 10 x 6 m with its corner at the origin.
struct Drive {
  explicit Drive(BaseKind kind, double half_length = 0.35, double width = 0.5)
      : Drive(NavigatorOptions{.base = {.kind = kind, .min_turning_radius = 0.4}}, free_grid(0, 0, 10, 6),
              half_length, width) {
    restart();
  }
  Drive(const NavigatorOptions& given, const maps::OccupancyGrid& floor, double half_length = 0.35,
        double width = 0.5)
      : body(Footprint::rectangle(half_length, half_length, width)), options(given), grid(floor) {
    costmap.update(grid);
  }
  /// Makes the navigator, with the present options.
  void restart() { navigator.emplace(body, options, costmap); }
  /// The same for a solver with few samples, which is fast.
  void restart_fast(int threads = 1) {
    SvgMppiOptions solver = svg_mppi_options(options.base);
    solver.samples = 512;
    solver.guides.iterations = 3;
    solver.threads = threads;
    navigator.emplace(body, options, solver, costmap);
  }
  void start(const maps::Pose& from, const std::vector<maps::Pose>& to, std::uint64_t seed = 1) {
    pose = from;
    path = to;
    navigator->reset(seed);
    navigator->set_path(path);
  }
  /// Puts something into a rectangle, m.
  void block(double x0, double y0, double x1, double y1) {
    fill(grid, x0, y0, x1, y1);
    costmap.update(grid);
  }
  NavigationResult update(std::span<const maps::PredictedObstacle> others = {}) {
    return move(navigator->update(pose, velocity, costmap, drive_period, others));
  }
  NavigationResult move(const NavigationResult& result) {
    command = result.command;
    velocity = plant(command);
    pose = moved(pose, velocity, drive_period);
    collided = collided || costmap.collides(body, pose);
    const int now = velocity.forward > 0.03 ? 1 : velocity.forward < -0.03 ? -1 : 0;
    reversals += now != 0 && last_direction != 0 && now != last_direction;
    if (now != 0) last_direction = now;
    return result;
  }
  NavigationStatus step() { return update().status; }
  /// Drives until the goal is reached, or for so long (s).
  NavigationStatus drive(double duration) {
    NavigationStatus status = NavigationStatus::following;
    for (time = 0; time < duration && status != NavigationStatus::goal_reached; time += drive_period)
      status = step();
    return status;
  }
  double goal_distance() const { return std::hypot(pose.x - path.back().x, pose.y - path.back().y); }

  Footprint body;
  NavigatorOptions options;
  maps::OccupancyGrid grid;
  Costmap costmap{grid.width, grid.height, grid.resolution};
  std::optional<Navigator> navigator;
  std::vector<maps::Pose> path;
  maps::Pose pose;
  Velocity velocity, command;
  std::function<Velocity(const Velocity&)> plant = [](const Velocity& asked) { return asked; };
  bool collided = false;
  int reversals = 0, last_direction = 0;
  double time = 0;
};

}  // namespace slalom::navigation
