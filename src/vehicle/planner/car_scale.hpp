#pragma once

#include <cmath>

#include "slalom/maps/body_room.hpp"
#include "slalom/vehicle/model/path_tracking_options.hpp"

namespace slalom::vehicle::detail {

/// The size of a car over that of the 1/10-scale car, for which the numbers of the planner are given. Times
/// and speeds are in proportion to the square root of lengths: so a car of the same grip stops from a speed
/// within as many of its own lengths, and turns with it on as many.
struct CarScale {
  static constexpr double same_way = 1;  ///< rad between cars, or a car and the path, that go the same way
  double length = 1;                     ///< factor of lengths
  double speed = 1;                      ///< factor of speeds and times

  static CarScale of(const BodyOptions& body) noexcept {
    const double length = maps::body_scale(body.front + body.rear);
    return {length, std::sqrt(length)};
  }
};

/// Errors of what sensors show, m. They do not depend on the car.
struct SensorErrors {
  static constexpr double reading = 0.02;  ///< m, between a wall and the nearest of many noisy readings of it
  static constexpr double body = 0.03;     ///< m, of a reading of a body, and of a pose that touches one
  static constexpr double wall = 0.15;     ///< m, of a reading of a wall at a small angle
  static constexpr double tracked = 0.12;  ///< m, between a reading of a car and its predicted box
};

}  // namespace slalom::vehicle::detail
