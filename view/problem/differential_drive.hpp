#pragma once

#include "slalom/problems/differential_drive.hpp"
#include "slalom/view/serve.hpp"

namespace slalom::view {

/// Returns the drawing of a robot among discs that can be moved, as its goal can. The problem's discs have
/// the robot's radius added; they are drawn without it, since the robot is.
inline Drawing<problems::DifferentialDrive> drawing_among_discs() {
  using problems::DifferentialDrive;
  using State = DifferentialDrive::State<double>;
  constexpr double length = 0.5, width = 0.4;
  const auto discs = [radius = std::hypot(length / 2, width / 2)](const DifferentialDrive& p) {
    std::vector<Shape> all;
    for (const problems::Disc& each : p.discs) all.push_back(disc(each.x, each.y, each.radius - radius));
    all.push_back(disc(p.goal_x, p.goal_y, 0.2, ShapeKind::goal));
    return all;
  };
  const auto move = [](DifferentialDrive& p, int shape, const maps::Point& to) {
    const auto index = static_cast<std::size_t>(shape);
    const bool is_goal = index == p.discs.size();
    (is_goal ? p.goal_x : p.discs[index].x) = to.x;
    (is_goal ? p.goal_y : p.discs[index].y) = to.y;
  };
  return {.x = &State::x,
          .y = &State::y,
          .heading = &State::yaw,
          .length = length,
          .width = width,
          .shapes = discs,
          .move = move,
          .states = {"x, m", "y, m", "yaw, rad"},
          .inputs = {"speed, m/s", "yaw rate, rad/s"},
          .title = "differential_drive"};
}

}  // namespace slalom::view
