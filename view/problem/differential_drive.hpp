#pragma once

#include "slalom/problems/differential_drive.hpp"
#include "slalom/view/serve.hpp"

namespace slalom::view {

/// Returns the drawing of a robot among discs that can be moved.
inline Drawing<problems::DifferentialDrive> drawing_among_discs() {
  using problems::DifferentialDrive;
  using State = DifferentialDrive::State<double>;
  const auto discs = [](const DifferentialDrive& p) {
    std::vector<Shape> all;
    for (const problems::Disc& each : p.discs) all.push_back(disc(each.x, each.y, each.radius));
    return all;
  };
  const auto move = [](DifferentialDrive& p, int shape, const maps::Point& to) {
    problems::Disc& disc = p.discs[static_cast<std::size_t>(shape)];
    disc.x = to.x, disc.y = to.y;
  };
  return {.x = &State::x,
          .y = &State::y,
          .heading = &State::yaw,
          .length = 0.5,
          .width = 0.4,
          .shapes = discs,
          .move = move,
          .states = {"x, m", "y, m", "yaw, rad"},
          .inputs = {"speed, m/s", "yaw rate, rad/s"},
          .title = "differential_drive"};
}

}  // namespace slalom::view
